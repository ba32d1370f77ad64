// SPDX-License-Identifier: Apache-2.0
// A small curve without axes: what has been, at a glance.

import { set, svg } from '../dom';

const kWidth = 300;
const kHeight = 36;

export interface Curve {
  /** From (0, 0) at the lower left to (1, 1) at the upper right. */
  readonly points: readonly (readonly [number, number])[];
  /** The height of a dashed rule. */
  readonly rule?: number;
  /** What the upper end stands for. */
  readonly top: string;
}

export function sparkline(): { element: SVGSVGElement; show: (curve: Curve) => void } {
  const rule = svg('path', { class: 'spark-rule' });
  const line = svg('path', { class: 'spark' });
  const top = svg('text', { x: '99%', y: 11, 'text-anchor': 'end' });
  const plot = svg('svg', { viewBox: `0 0 ${kWidth} ${kHeight}`, preserveAspectRatio: 'none', class: 'sparkline', 'aria-hidden': 'true' }, rule, line);
  const height = (y: number): string => (kHeight - 2 - Math.min(Math.max(y, 0), 1) * (kHeight - 4)).toFixed(1);
  return {
    element: svg('svg', { class: 'spark-box', height: kHeight, 'aria-hidden': 'true' }, plot, top),
    show: (curve) => {
      const drawn = curve.points.length > 1;
      const points = curve.points.map(([x, y]) => `${(x * kWidth).toFixed(1)} ${height(y)}`);
      set(line, { d: drawn ? `M${points.join('L')}` : '' });
      set(rule, { d: drawn && curve.rule !== undefined ? `M0 ${height(curve.rule)}H${kWidth}` : '' });
      top.textContent = drawn ? curve.top : '';
    },
  };
}

export function latencyCurve(milliseconds: readonly number[]): Curve {
  const most = Math.max(1, ...milliseconds);
  const slots = Math.max(milliseconds.length, 30);
  return { points: milliseconds.map((value, i) => [(i + 0.5) / slots, value / most]), top: `${most.toFixed(0)} ms` };
}
