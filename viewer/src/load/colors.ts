// SPDX-License-Identifier: Apache-2.0
// Colours of the load: one for each worker, and a scale for costs.

import type { Vec3 } from '../vector';

/** Okabe and Ito's colours, told apart by the colour-blind (Color Universal Design, 2008). */
const kFew = ['#e69f00', '#56b4e9', '#009e73', '#f0e442', '#0072b2', '#d55e00', '#cc79a7'] as const;
const kGoldenAngle = 137.508;

/** Of the i-th worker. More than the few differ in lightness too, and the tiles have numbers. */
export function workerColor(i: number): string {
  const more = i - kFew.length;
  return kFew[i] ?? `hsl(${((40 + kGoldenAngle * more) % 360).toFixed(0)} 62% ${[70, 48, 82][more % 3]}%)`;
}

/** Viridis (Smith and van der Walt, 2015): equal steps look equal, in grey and to the colour-blind too. */
const kViridis: readonly Vec3[] = ['440154', '482576', '414487', '35608d', '2a788e', '21908c', '22a884', '43bf71', '7ad151',
  'bbdf27', 'fde725'].map((hex) => [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16)) as unknown as Vec3);

/** 8-bit sRGB of a value from 0 to 1. */
export function viridis(value: number): Vec3 {
  const place = Math.min(Math.max(value, 0), 1) * (kViridis.length - 1);
  const lower = Math.min(Math.floor(place), kViridis.length - 2);
  const part = place - lower;
  return kViridis[lower]!.map((low, c) => Math.round((1 - part) * low + part * kViridis[lower + 1]![c]!)) as unknown as Vec3;
}

export const cssOf = ([r, g, b]: Vec3, alpha = 1): string => `rgb(${r} ${g} ${b} / ${alpha})`;
