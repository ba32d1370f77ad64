// SPDX-License-Identifier: Apache-2.0
// Image size, background, ray step and display. While the size follows the window, it is asked for again
// whenever the window's changes have come to rest.

import { colorField, numberField, section, selectField } from '../controls';
import { el } from '../dom';
import { fitted } from '../image-size';
import type { Session } from '../session';
import { displayControls } from './display';

type SizeChoice = 'fit' | 'full' | 'keep' | '256' | '512' | '768' | '1024';

const kChoices = [
  ['fit', 'Fit the window, at most 1024'], ['full', 'Fit the window, full resolution'], ['keep', 'As the session has it'],
  ['256', '256 × 256'], ['512', '512 × 512'], ['768', '768 × 768'], ['1024', '1024 × 1024'],
] as const satisfies readonly (readonly [SizeChoice, string])[];

const kRestMs = 250;
const kFitEdge = 1024;
const kLargestEdge = 4096;

export function imagePanel(session: Session, stage: HTMLElement): HTMLElement {
  let choice: SizeChoice = 'fit';
  let timer = 0;
  const now = el('output', {}, '–');
  const size = selectField<SizeChoice>('Size', kChoices, (value) => { choice = value; ask(); });
  const background = colorField('Background', (rgb) => session.edit({ background: rgb }, 'background'));
  const step = numberField('Ray step, at most', { low: 0, high: 1e6, unit: 'mm' }, (value) => session.edit({ step: value }, 'step'));
  step.element.title = '0 lets the error target choose';

  const ask = (): void => {
    if (choice === 'keep') return;
    const { width, height } = choice === 'fit' || choice === 'full'
      ? fitted(stage.clientWidth, stage.clientHeight, devicePixelRatio, choice === 'fit' ? kFitEdge : kLargestEdge)
      : { width: Number(choice), height: Number(choice) };
    session.askSize(width, height);
  };
  new ResizeObserver(() => {
    window.clearTimeout(timer);
    timer = window.setTimeout(() => { if (choice === 'fit' || choice === 'full') ask(); }, kRestMs);
  }).observe(stage);
  let drove = false;
  session.changed.listen((topic) => {
    if (topic === 'connection' && !session.connected) drove = false;
    if (topic === 'driver' && session.drives !== drove) {
      drove = session.drives;
      if (session.sizeFixed && choice === 'fit') choice = 'keep';
      size.show(choice);
      if (drove) ask();
    }
    if (topic === 'camera' || topic === 'picture') now.textContent = `${session.size.width} × ${session.size.height} pixels`;
    if (topic === 'refused' && session.refusal?.where === 'size') {
      choice = 'keep';
      size.show(choice);
    }
    if (topic === 'scene' && session.editable) {
      background.show(session.editable.background);
      step.show(session.editable.step);
    }
  });
  background.element.dataset.control = 'background';
  step.element.dataset.control = 'step';
  return section('Image', false, size.element,
    el('div', { class: 'row' }, el('span', { class: 'label' }, 'Now'), now), background.element, step.element,
    displayControls(session));
}
