// SPDX-License-Identifier: Apache-2.0
// Screenshot and link.

import { button, checkField, section } from './controls';
import { el } from './dom';
import { linkOf } from './link';
import type { Session } from './session';

/** Saves the picture as a PNG of exactly its pixels. */
export function saveScreenshot(session: Session, canvas: HTMLCanvasElement): void {
  canvas.toBlob((blob) => {
    if (!blob || !session.picture) return session.say('There is no picture to save yet.');
    const name = (session.volume?.name || 'goldthread').replace(/[^\p{L}\p{N}._-]+/gu, '-');
    const link = el('a', { href: URL.createObjectURL(blob), download: `${name}-${session.picture.picture}.png` });
    link.click();
    window.setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    session.say(session.picture.final ? `Saved ${link.download}.` : `Saved ${link.download}; the picture was not yet final.`);
  }, 'image/png');
}

export function sharePanel(session: Session, canvas: HTMLCanvasElement): HTMLElement {
  let withToken = false;
  const token = checkField('Link includes the access token', (value) => { withToken = value; });
  token.element.title = 'Whoever has the token can take over this session';
  const address = el('input', { type: 'text', readOnly: true, hidden: true, aria: { label: 'Link' } });
  const copy = async (): Promise<void> => {
    const { camera, editable } = session;
    if (!camera || !editable) return;
    const link = linkOf(location.href, { camera, editable }, withToken);
    try {
      await navigator.clipboard.writeText(link);
      address.hidden = true;
      session.say(withToken ? 'Link with the access token copied.' : 'Link copied, without the access token.');
    } catch {
      // Browsers give the clipboard to secure origins only: let the user copy by hand.
      address.hidden = false;
      address.value = link;
      address.select();
      session.say('Press Ctrl+C to copy the link.');
    }
  };
  return section('Share', true,
    el('div', { class: 'buttons' },
      button('Screenshot', 'Save the picture as PNG at its full resolution (s)', () => saveScreenshot(session, canvas)),
      button('Copy link', 'Copy a link to this camera and appearance', () => void copy())),
    address, token.element);
}
