// SPDX-License-Identifier: Apache-2.0
// Shows what the server refused at the control that asked for it, until the next edit.

import { el } from './dom';
import type { Session } from './session';

export function showRefusals(session: Session, panel: HTMLElement): void {
  const note = el('p', { class: 'problem', role: 'alert' });
  session.changed.listen((topic) => {
    if (topic === 'scene' && !session.refusal) note.remove();
    if (topic !== 'refused' || !session.refusal) return;
    const { control, what, mend } = session.refusal;
    note.textContent = `Refused: ${what}${mend ? ` (${mend})` : ''}`;
    const name = control.split('.')[0]!;
    const place = name && [...panel.querySelectorAll<HTMLElement>('[data-control]')].find((e) => e.dataset.control === name);
    if (!place) return session.say(note.textContent);
    place.after(note);
    const details = place.closest('details');
    if (details) details.open = true;
    note.scrollIntoView({ block: 'nearest' });
  });
}
