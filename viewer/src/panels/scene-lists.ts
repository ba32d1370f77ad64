// SPDX-License-Identifier: Apache-2.0
// Isosurfaces and lights: lists whose rows are edited in place. A list is rebuilt only when its
// shape changes, so that a row that is being edited keeps the focus.

import { button, colorInput, numberField, section, selectField, vectorField } from '../controls';
import { el } from '../dom';
import type { Isosurface, Light, LightType } from '../scene';
import type { Session } from '../session';
import type { Vec3 } from '../vector';

interface Row<T> {
  readonly element: HTMLElement;
  show(item: T): void;
}

/** A list that keeps its rows while `shapeOf` says that they still fit. */
function listOf<T>(shapeOf: (item: T) => string, makeRow: (index: number, item: T) => Row<T>):
  { element: HTMLElement; show: (items: readonly T[]) => void } {
  const element = el('ul', { class: 'list' });
  let rows: Row<T>[] = [];
  let shape = '';
  return {
    element,
    show: (items) => {
      const next = JSON.stringify(items.map(shapeOf));
      if (next !== shape) {
        rows = items.map((item, i) => makeRow(i, item));
        element.replaceChildren(...rows.map((row) => row.element));
        shape = next;
      }
      rows.forEach((row, i) => row.show(items[i]!));
    },
  };
}

const replaced = <T>(items: readonly T[], index: number, part: Partial<T>): T[] =>
  items.map((item, i) => (i === index ? { ...item, ...part } : item));

export function isosurfacePanel(session: Session): HTMLElement {
  const items = (): readonly Isosurface[] => session.editable?.volume.isosurfaces ?? [];
  const report = (isosurfaces: Isosurface[]): void => session.edit({ volume: { isosurfaces } }, 'isosurfaces');
  const list = listOf<Isosurface>(() => {
    const range = session.volume?.range ?? [0, 1];
    return `iso ${range[0]} ${range[1]}`;
  }, (index) => {
    const change = (part: Partial<Isosurface>): void => report(replaced(items(), index, part));
    const [low, high] = session.volume?.range ?? [0, 1];
    const value = numberField('Value', { low, high, slider: true }, (v) => change({ value: v }));
    const opacity = numberField('Opacity', { low: 0, high: 1, slider: true }, (a) => change({ opacity: a }));
    const color = colorInput(`Colour of isosurface ${index + 1}`, (rgb) => change({ color: rgb }));
    const remove = button('Remove', `Remove isosurface ${index + 1}`, () => report(items().filter((_, i) => i !== index)));
    return {
      element: el('li', {}, el('div', { class: 'item-head' }, color.element, el('span', { class: 'grow' }, `Surface ${index + 1}`), remove),
        value.element, opacity.element),
      show: (item) => { value.show(item.value); opacity.show(item.opacity); color.show(item.color); },
    };
  });
  const add = button('Add a surface', 'Add an isosurface in the middle of the data range', () => {
    const [low, high] = session.volume?.range ?? [0, 1];
    report([...items(), { value: Number(((low + high) / 2).toPrecision(5)), color: [0.9, 0.8, 0.7], opacity: 1 }]);
  });
  session.changed.listen((topic) => { if (topic === 'scene') list.show(items()); });
  const body = el('div', { data: { control: 'isosurfaces' } }, list.element, el('div', { class: 'buttons' }, add));
  return section('Isosurfaces', false, body);
}

const kLightTypes = [['headlight', 'Headlight'], ['directional', 'Directional'], ['point', 'Point']] as const;

export function lightPanel(session: Session): HTMLElement {
  const items = (): readonly Light[] => session.editable?.lights ?? [];
  const report = (lights: Light[]): void => session.edit({ lights }, 'lights');
  const list = listOf<Light>((light) => light.type, (index, light) => lightRow(session, index, light.type, items, report));
  const add = button('Add a light', 'Add a light', () => {
    const direction: Vec3 = [-0.5, 0.7, -0.5];
    report([...items(), { type: 'directional', intensity: 0.7, color: [1, 1, 1], direction }]);
  });
  session.changed.listen((topic) => { if (topic === 'scene') list.show(items()); });
  return section('Lights', false,
    el('div', { data: { control: 'lights' } }, list.element, el('div', { class: 'buttons' }, add)));
}

function lightRow(session: Session, index: number, kind: LightType, items: () => readonly Light[],
  report: (lights: Light[]) => void): Row<Light> {
  const change = (part: Partial<Light>): void => report(replaced(items(), index, part));
  const type = selectField<LightType>('Type', kLightTypes, (to) =>
    report(items().map((light, i) => (i === index ? retyped(session, light, to) : light))));
  const intensity = numberField('Intensity', { low: 0, high: 3, slider: true }, (v) => change({ intensity: v }));
  const color = colorInput(`Colour of light ${index + 1}`, (rgb) => change({ color: rgb }));
  const place = kind === 'directional' ? vectorField('Shines towards', (direction) => change({ direction }))
    : kind === 'point' ? vectorField('Position, mm', (position) => change({ position })) : null;
  const remove = button('Remove', `Remove light ${index + 1}`, () => report(items().filter((_, i) => i !== index)));
  return {
    element: el('li', {}, el('div', { class: 'item-head' }, color.element, el('span', { class: 'grow' }, `Light ${index + 1}`), remove),
      type.element, intensity.element, place?.element ?? null),
    show: (light) => {
      type.show(light.type);
      intensity.show(light.intensity);
      color.show(light.color);
      place?.show(light.direction ?? light.position ?? [0, 0, 0]);
    },
  };
}

/** The same light as another type, where the camera is for a point light. */
function retyped(session: Session, { intensity, color }: Light, type: LightType): Light {
  if (type === 'directional') return { type, intensity, color, direction: [0, 1, 0] };
  if (type === 'point') return { type, intensity, color, position: session.camera?.position ?? [0, 0, 0] };
  return { type, intensity, color };
}
