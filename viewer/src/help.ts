// SPDX-License-Identifier: Apache-2.0
// The overlay that lists gestures and keys.

import { button } from './controls';
import { el } from './dom';

const kHelp: readonly (readonly [string, readonly (readonly [string, string])[]])[] = [
  ['On the picture', [
    ['Left drag, one finger', 'turn'], ['Middle or Shift + left drag', 'move'], ['Wheel, right drag, pinch', 'zoom'],
    ['Ctrl + left drag', 'roll'], ['Two fingers', 'move, zoom and roll'],
  ]],
  ['Keys on the picture', [
    ['Arrows', 'turn by 5°'], ['Shift + arrows', 'move'], ['+  −', 'zoom'], ['[  ]', 'roll'],
  ]],
  ['Keys everywhere', [
    ['r', 'frame the volume'], ['Home', 'the scene’s camera'], ['p', 'fold or unfold the panel'], ['s', 'save a screenshot'],
    ['c', 'rock when at rest'], ['o', 'who cast each tile'], ['t', 'the time each tile took'], ['l', 'the load of each rank'],
    ['Ctrl + Z, Ctrl + Shift + Z', 'undo, redo'], ['?', 'this help'],
  ]],
  ['On a transfer function’s node', [
    ['Drag, arrows', 'move (Shift: finely)'], ['Double-click in the plot, Insert', 'add a node'],
    ['Double-click on it, Delete', 'delete the node'], ['Enter on a colour node', 'choose its colour'],
  ]],
];

export function helpDialog(): HTMLDialogElement {
  const dialog = el('dialog', { class: 'help', aria: { labelledby: 'help-title' } });
  dialog.append(
    el('header', {}, el('h2', { id: 'help-title' }, 'Gestures and keys'), button('Close', 'Close (Esc)', () => dialog.close())),
    el('div', { class: 'help-columns' }, ...kHelp.map(([title, rows]) => el('section', {}, el('h3', {}, title),
      el('dl', {}, ...rows.flatMap(([keys, effect]) => [el('dt', {}, keys), el('dd', {}, effect)]))))),
  );
  dialog.addEventListener('click', (event) => { if (event.target === dialog) dialog.close(); });
  return dialog;
}
