// SPDX-License-Identifier: Apache-2.0
// How pictures are displayed. These are no edits of the scene and cannot be undone; a watching page
// shows what the driver has chosen.

import { checkField, selectField } from '../controls';
import type { Filter, Update } from '../display';
import { el } from '../dom';
import type { Session } from '../session';

const kFilters = [
  ['box', 'Box'], ['bilinear', 'Bilinear'], ['biquadratic', 'Biquadratic'],
  ['piecewise-quadratic', 'Piecewise quadratic'], ['bicubic', 'Bicubic'],
] as const satisfies readonly (readonly [Filter, string])[];

const kUpdates = [
  ['100', '100 %: every sample'], ['50', '50 %: half of them in turn'], ['25', '25 %: a quarter in turn'],
  ['frameless', 'Frameless: scattered in turn'],
] as const satisfies readonly (readonly [Update, string])[];

export function displayControls(session: Session): HTMLElement {
  const filter = selectField<Filter>('Reconstruction', kFilters, (value) => session.choose({ filter: value }));
  filter.element.title = 'How pixels come from samples';
  const update = selectField<Update>('Update while moving', kUpdates, (value) => session.choose({ update: value }));
  update.element.title = 'How much of a moving picture is cast anew each time: less is quicker and smears';
  const cine = checkField('Rock when at rest (cine loop)', (value) => session.choose({ cine: value }));
  cine.element.title = 'Show the resting picture from a few angles, back and forth (c)';
  session.changed.listen((topic) => {
    if (topic !== 'display') return;
    filter.show(session.display.filter);
    update.show(session.display.update);
    cine.show(session.display.cine);
  });
  return el('div', { class: 'group', data: { control: 'display' } }, filter.element, update.element, cine.element);
}
