// SPDX-License-Identifier: Apache-2.0
// Keys that work everywhere except where text is typed.

import type { OverlayMode } from './load/tile-overlay';
import type { Session } from './session';

export interface ShortcutActions {
  help(): void;
  fold(): void;
  screenshot(): void;
  /** On, or off if it is on. */
  overlay(mode: OverlayMode): void;
  load(): void;
}

const typing = (target: EventTarget | null): boolean =>
  target instanceof HTMLElement && (target.matches('input:not([type=range], [type=checkbox], [type=radio], [type=color]), select, textarea'));

function toggleCine(session: Session): void {
  if (!session.drives) return;
  const cine = !session.display.cine;
  session.choose({ cine });
  session.say(cine ? 'The picture will rock when it is at rest.' : 'The picture will stand still when it is at rest.');
}

export function installShortcuts(session: Session, actions: ShortcutActions): void {
  window.addEventListener('keydown', (event) => {
    if (typing(event.target) || event.altKey) return;
    const key = event.key.toLowerCase();
    if (event.ctrlKey || event.metaKey) {
      if (key === 'z' && !event.shiftKey) session.undo();
      else if (key === 'y' || key === 'z') session.redo();
      else return;
    } else if (event.key === '?') actions.help();
    else if (key === 'r') session.frameVolume();
    else if (key === 'home' && session.original && !(event.target instanceof HTMLInputElement)) session.moveCamera(session.original.camera);
    else if (key === 'p') actions.fold();
    else if (key === 's') actions.screenshot();
    else if (key === 'c') toggleCine(session);
    else if (key === 'o') actions.overlay('owners');
    else if (key === 't') actions.overlay('cost');
    else if (key === 'l') actions.load();
    else return;
    event.preventDefault();
  });
}
