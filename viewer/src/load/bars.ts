// SPDX-License-Identifier: Apache-2.0
// VOL2's bar graph (State et al. 1995): the work of each rank, normalised to the highest, with the
// workers' mean as a line. Many ranks get thin bars without words, which tell themselves when pointed at.

import { el } from '../dom';
import { imbalance, isWorker, timeText, workOf, type Span } from './measures';
import type { RankLoad } from './messages';

/** Up to so many bars have words, and all bars together this height where that leaves them visible. */
const kWorded = 16;
const kHeight = 240;
const kThinnest = 3;

interface Bar { row: HTMLElement; name: HTMLElement; fill: HTMLElement; value: HTMLElement }

const nameOf = (rank: RankLoad): string => (isWorker(rank) ? String(rank.rank) : `${rank.rank} ${rank.role}`);

const valueOf = (rank: RankLoad, span: Span): string => {
  const work = workOf(rank, span);
  if (rank.lost) return 'lost';
  return work === null ? '–' : span === 'second' ? `${(100 * work).toFixed(0)} %` : timeText(1000 * work);
};

export interface BarGraph {
  readonly element: HTMLElement;
  /** `color`: of a worker, by its rank. */
  show(ranks: readonly RankLoad[], span: Span, color: (rank: number) => string): void;
}

export function barGraph(): BarGraph {
  const figure = el('strong');
  const detail = el('span', { class: 'muted' });
  const mean = el('div', { class: 'mean', title: 'Mean of the workers' });
  const list = el('div', { class: 'load-bars', role: 'list', tabIndex: 0, aria: { label: 'Work of each rank, normalised to the highest' } });
  let bars: Bar[] = [];

  const addBar = (): void => {
    const name = el('span', { class: 'name' }), fill = el('span', { class: 'fill' }), value = el('span', { class: 'value' });
    const row = el('div', { class: 'load-bar', role: 'listitem' }, name, el('span', { class: 'track' }, fill), value);
    bars.push({ row, name, fill, value });
    list.append(row);
  };
  list.append(mean);
  const showBars = (ranks: readonly RankLoad[], span: Span, color: (rank: number) => string): void => {
    const highest = Math.max(...ranks.map((rank) => (rank.lost ? 0 : workOf(rank, span) ?? 0)), 1e-9);
    while (bars.length < ranks.length) addBar();
    for (const { row } of bars.splice(ranks.length)) row.remove();
    bars.forEach(({ row, name, fill, value }, i) => {
      const rank = ranks[i]!;
      row.dataset.role = rank.role;
      row.classList.toggle('lost', rank.lost);
      row.title = `Rank ${rank.rank}, ${rank.role}: ${valueOf(rank, span)}`;
      name.textContent = nameOf(rank);
      name.style.setProperty('--chip', isWorker(rank) ? color(rank.rank) : 'transparent');
      fill.style.width = rank.lost ? '0' : `${(100 * (workOf(rank, span) ?? 0)) / highest}%`;
      value.textContent = valueOf(rank, span);
    });
    const workers = ranks.filter((rank) => isWorker(rank) && !rank.lost);
    const sum = workers.reduce((total, rank) => total + (workOf(rank, span) ?? 0), 0);
    mean.hidden = !(sum > 0);
    if (sum > 0) mean.style.setProperty('--mean', String(sum / workers.length / highest));
  };

  return {
    element: el('div', { class: 'load-graph' }, el('p', { class: 'imbalance', title: 'How much longer the busiest worker works than the mean: max/mean − 1' },
      figure, detail), list),
    show: (all, span, color) => {
      const known = all.filter((rank) => rank.lost || workOf(rank, span) !== null);
      const ranks = [...known.filter(isWorker), ...known.filter((rank) => !isWorker(rank)).reverse()];
      const thin = ranks.length > kWorded;
      list.classList.toggle('thin', thin);
      list.style.setProperty('--bar', thin ? `${Math.max(kThinnest, Math.floor(kHeight / ranks.length) - 1)}px` : '10px');
      showBars(ranks, span, color);
      const uneven = imbalance(all, span);
      figure.textContent = uneven ? `${(100 * uneven.excess).toFixed(0)} %` : '–';
      detail.textContent = uneven ? ` imbalance · rank ${uneven.busiest} is the busiest` : ' imbalance · no worker has work';
    },
  };
}
