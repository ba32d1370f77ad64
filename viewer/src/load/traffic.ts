// SPDX-License-Identifier: Apache-2.0
// What the ranks send each other, by kind of message.

import { el } from '../dom';
import { bytesText } from './measures';
import type { Traffic } from './messages';

export function trafficTable(): { element: HTMLElement; show: (bytes: readonly Traffic[]) => void } {
  const body = el('tbody');
  const foot = el('tfoot');
  const heads = [['Message', ''], ['Per second', 'right'], ['In all', 'right']] as const;
  const head = el('tr', {}, ...heads.map(([name, style]) => el('th', { scope: 'col', class: style }, name)));
  const rowOf = ({ kind, perSecond, total, messages }: Traffic, most: number): HTMLElement => {
    const rate = perSecond > 0 ? bytesText(perSecond) : '–';
    const row = el('tr', { title: `${messages.toLocaleString('en')} messages` }, el('th', { scope: 'row' }, kind),
      el('td', { class: 'right' }, rate), el('td', { class: 'right' }, bytesText(total)));
    row.style.setProperty('--part', String(most > 0 ? perSecond / most : 0));
    return row;
  };
  return {
    element: el('table', { class: 'traffic' }, el('thead', {}, head), body, foot),
    show: (bytes) => {
      const most = Math.max(0, ...bytes.map(({ perSecond }) => perSecond));
      const sum = (of: (traffic: Traffic) => number): number => bytes.reduce((total, traffic) => total + of(traffic), 0);
      body.replaceChildren(...bytes.map((traffic) => rowOf(traffic, most)));
      foot.replaceChildren(rowOf({ kind: 'All', messages: sum((t) => t.messages), total: sum((t) => t.total), perSecond: sum((t) => t.perSecond) }, 0));
    },
  };
}
