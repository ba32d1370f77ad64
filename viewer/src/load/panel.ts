// SPDX-License-Identifier: Apache-2.0
// How the work is spread: bars, time lines, bytes, and the choice of what lies over the picture. The
// server is asked for it only while it can be seen.

import { section, segmented } from '../controls';
import { el } from '../dom';
import type { Session } from '../session';
import { barGraph } from './bars';
import type { Span } from './measures';
import type { OverlayMode, TileOverlay } from './tile-overlay';
import { timeline } from './timeline';
import { trafficTable } from './traffic';

export function loadPanel(session: Session, tiles: TileOverlay): HTMLDetailsElement {
  let span: Span = 'second';
  let opened = false;
  const bars = barGraph();
  const lanes = timeline();
  const traffic = trafficTable();
  const overlay = segmented<OverlayMode>('Over the picture', [['none', 'Nothing', 'The picture alone'],
    ['owners', 'Owners', 'Which worker cast each tile (o)'], ['cost', 'Cost', 'What each tile took (t)']], (mode) => tiles.choose(mode));
  const spans = segmented<Span>('Work of', [['second', 'Last second', 'Busy time of the last second'],
    ['view', 'Newest view', 'Time spent on the newest view of which all tiles are cast']], (chosen) => { span = chosen; update(); });
  const update = (): void => {
    const { load } = session;
    if (!load || !session.watches.load) return;
    bars.show(load.ranks, span, (rank) => tiles.colorOf(rank));
    lanes.show(load);
    traffic.show(load.bytes);
    if (opened) element.scrollIntoView({ block: 'start' });
    opened = false;
  };
  overlay.show(tiles.mode);
  spans.show(span);
  tiles.changed.listen((mode) => overlay.show(mode));
  session.changed.listen((topic) => { if (topic === 'load') update(); });

  const content = el('div', { class: 'load' }, el('h3', {}, 'Over the picture'), overlay.element, el('h3', {}, 'Work of each rank'), spans.element,
    bars.element, lanes.element, el('h3', {}, 'Bytes by kind of message'), traffic.element);
  // Closed, folded and scrolled away: all of them are out of view.
  new IntersectionObserver((entries) => session.watch({ load: entries.at(-1)!.isIntersecting })).observe(content);
  const element = section('Load', false, content);
  element.addEventListener('toggle', () => { opened = element.open; });
  return element;
}
