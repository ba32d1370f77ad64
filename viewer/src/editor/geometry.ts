// SPDX-License-Identifier: Apache-2.0
// Where values and opacities lie in the editor. Opacity has a square-root axis: what matters in a
// volume are its small opacities, which a linear axis would press against the floor.

import { opacityAt } from '../transfer-function';
import type { OpacityNode } from '../scene';

export interface Plot {
  readonly width: number;
  readonly height: number;
  readonly margin: number;
  readonly domain: readonly [number, number];
}

const clamp01 = (t: number): number => Math.min(Math.max(t, 0), 1);

export const xOf = (plot: Plot, value: number): number =>
  plot.margin + clamp01((value - plot.domain[0]) / (plot.domain[1] - plot.domain[0])) * (plot.width - 2 * plot.margin);

export const valueOf = (plot: Plot, x: number): number =>
  plot.domain[0] + clamp01((x - plot.margin) / Math.max(plot.width - 2 * plot.margin, 1))
    * (plot.domain[1] - plot.domain[0]);

export const yOf = (plot: Plot, alpha: number): number =>
  plot.height - plot.margin - Math.sqrt(clamp01(alpha)) * (plot.height - 2 * plot.margin);

export const alphaOf = (plot: Plot, y: number): number =>
  clamp01((plot.height - plot.margin - y) / Math.max(plot.height - 2 * plot.margin, 1)) ** 2;

/** The opacity curve as an SVG path: straight in opacity, hence bent on this axis. */
export function curvePath(plot: Plot, nodes: readonly OpacityNode[]): string {
  const [low, high] = plot.domain;
  const values = Array.from({ length: 129 }, (_, i) => low + ((high - low) * i) / 128);
  const points = [
    ...values.map((value) => [value, opacityAt(nodes, value)] as const),
    ...nodes,
  ].map(([value, alpha], order) => ({ value, alpha, order })).sort((a, b) => a.value - b.value || a.order - b.order);
  return points.map(({ value, alpha }, i) =>
    `${i === 0 ? 'M' : 'L'}${xOf(plot, value).toFixed(1)} ${yOf(plot, alpha).toFixed(1)}`).join('');
}

/** The histogram on a logarithmic scale as a closed SVG path over the data's `range`. */
export function histogramPath(plot: Plot, histogram: readonly number[], range: readonly [number, number]): string {
  const most = Math.log1p(Math.max(0, ...histogram));
  if (!(most > 0)) return '';
  const floor = plot.height - plot.margin;
  const steps = histogram.map((n, i) => {
    const y = floor - (Math.log1p(Math.max(0, n)) / most) * (plot.height - 2 * plot.margin);
    const x = (bin: number): string => xOf(plot, range[0] + ((range[1] - range[0]) * bin) / histogram.length).toFixed(1);
    return `L${x(i)} ${y.toFixed(1)}L${x(i + 1)} ${y.toFixed(1)}`;
  });
  return `M${xOf(plot, range[0]).toFixed(1)} ${floor}${steps.join('')}L${xOf(plot, range[1]).toFixed(1)} ${floor}Z`;
}
