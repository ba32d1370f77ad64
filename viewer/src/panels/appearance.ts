// SPDX-License-Identifier: Apache-2.0
// Mode, presets, the transfer function and shading.

import { button, checkField, numberField, section, segmented, type Control } from '../controls';
import { el } from '../dom';
import { ColorEditor } from '../editor/color-editor';
import { OpacityEditor } from '../editor/opacity-editor';
import { presetsOf, type Preset } from '../presets';
import { kDefaultShading, type Mode, type Shading, type TransferFunction } from '../scene';
import type { Session } from '../session';

const kModes = [
  ['dvr', 'Volume', 'Emission and absorption along the ray'],
  ['isosurface', 'Surfaces', 'Isosurfaces only'],
  ['mip', 'Maximum', 'The greatest value along each ray'],
] as const satisfies readonly (readonly [Mode, string, string])[];

export function appearancePanel(session: Session): HTMLElement[] {
  const changeTf = (change: Partial<TransferFunction>, control: string): void => {
    const tf = session.editable?.volume.transferFunction;
    if (tf) session.edit({ volume: { transferFunction: { ...tf, ...change } } }, control);
  };
  const mode = segmented<Mode>('Mode', kModes, (value) => session.edit({ volume: { mode: value } }, 'mode'));
  const presets = presetMenu(session);
  // The count in a control's name makes adding and removing a node steps of their own for undo.
  const opacity = new OpacityEditor((nodes) => changeTf({ opacity: nodes }, `opacity.${nodes.length}`));
  const color = new ColorEditor((nodes) => changeTf({ color: nodes }, `color.${nodes.length}`));
  const distance = numberField('Unit distance', { low: 1e-6, high: 1e6, unit: 'mm' },
    (unitDistance) => changeTf({ unitDistance }, 'unitDistance'));
  distance.element.title = 'The length over which an opacity is reached: smaller is denser';
  const undo = button('Undo', 'Undo the last edit (Ctrl+Z)', () => session.undo());
  const redo = button('Redo', 'Redo (Ctrl+Shift+Z)', () => session.redo());
  const shading = shadingControls(session);

  const update = (): void => {
    const { editable, volume } = session;
    undo.disabled = !session.canUndo;
    redo.disabled = !session.canRedo;
    if (!editable || !volume) return;
    const { transferFunction } = editable.volume;
    mode.show(editable.volume.mode);
    opacity.show(transferFunction, volume, session.drives);
    color.show(transferFunction, volume, session.drives);
    distance.show(transferFunction.unitDistance);
    shading.show(editable.volume.shading);
  };
  session.changed.listen((topic) => { if (topic === 'scene' || topic === 'driver' || topic === 'connection') update(); });
  const named = (name: string, element: HTMLElement): HTMLElement => { element.dataset.control = name; return element; };
  return [
    section('Appearance', true, named('mode', mode.element), named('preset', presets), named('opacity', opacity.element),
      named('color', color.element), named('unitDistance', distance.element), el('div', { class: 'buttons' }, undo, redo)),
    section('Shading', true, named('shading', shading.element)),
  ];
}

function presetMenu(session: Session): HTMLElement {
  let presets: Preset[] = [];
  const menu = el('select', { aria: { label: 'Preset' } });
  menu.addEventListener('change', () => {
    const preset = presets[Number(menu.value)];
    menu.value = '';
    if (preset) session.edit({ volume: preset.look }, 'preset');
  });
  session.changed.listen((topic) => {
    if (topic !== 'connection' || !session.volume || !session.original) return;
    presets = presetsOf(session.volume, session.original.editable.volume);
    menu.replaceChildren(el('option', { value: '', selected: true }, 'Choose a preset …'),
      ...presets.map(({ name, hint }, i) => el('option', { value: String(i), title: hint }, `${name} – ${hint}`)));
  });
  return el('label', { class: 'row' }, el('span', { class: 'label' }, 'Preset'), menu);
}

function shadingControls(session: Session): Control<Shading | null> {
  let last = kDefaultShading;
  const change = (part: Partial<Shading>, control: string): void => {
    last = { ...last, ...part };
    session.edit({ volume: { shading: last } }, control);
  };
  const on = checkField('Shade with gradients', (value) => session.edit({ volume: { shading: value ? last : null } }, 'shading'));
  const part = (name: keyof Shading, label: string, high: number) =>
    [name, numberField(label, { low: 0, high, slider: true }, (value) => change({ [name]: value }, `shading.${name}`))] as const;
  const parts = [part('ambient', 'Ambient', 1), part('diffuse', 'Diffuse', 1), part('specular', 'Specular', 1),
    part('shininess', 'Shininess', 100)];
  const fields = el('fieldset', { class: 'plain' }, ...parts.map(([, field]) => field.element));
  return {
    element: el('div', {}, on.element, fields),
    show: (shading) => {
      last = shading ?? last;
      on.show(shading !== null);
      fields.disabled = shading === null;
      for (const [name, field] of parts) field.show(last[name]);
    },
  };
}
