// SPDX-License-Identifier: Apache-2.0
// A few transfer functions computed from the data's range and histogram. Landmarks are quantiles of
// the voxels above the background (the histogram's highest bin in its lower half), so that a preset
// lands on material rather than on empty range.

import type { ColorNode, OpacityNode, Shading, TransferFunction, VolumeLook } from './scene';
import { kDefaultShading } from './scene';
import type { VolumeInfo } from './protocol';

export interface Preset {
  readonly name: string;
  readonly hint: string;
  readonly look: Partial<VolumeLook>;
}

/** Value below which the fraction `p` of the voxels above the background lies. */
export function quantile(volume: Pick<VolumeInfo, 'range' | 'histogram'>, p: number): number {
  const { histogram, range: [low, high] } = volume;
  const bins = histogram.length;
  const lower = histogram.slice(0, Math.max(1, bins >> 1));
  const background = lower.indexOf(Math.max(...lower));
  const material = histogram.map((n, i) => (i > background ? Math.max(0, n) : 0));
  const total = material.reduce((sum, n) => sum + n, 0);
  if (bins === 0 || total === 0) return low + p * (high - low);
  let sum = 0;
  const bin = material.findIndex((n) => n > 0 && (sum += n) >= p * total);
  return low + ((bin + 0.5) / bins) * (high - low);
}

const rounded = (x: number): number => Number(x.toPrecision(5));

/** Nodes made from (position, …) pairs with positions made to ascend strictly within the range. */
function placed<T extends readonly number[]>(nodes: readonly T[]): T[] {
  let last = -Infinity;
  return nodes.map((node) => {
    last = Math.max(last, rounded(node[0]!));
    return [last, ...node.slice(1)] as unknown as T;
  });
}

function preset(name: string, hint: string, unitDistance: number, color: ColorNode[], opacity: OpacityNode[],
  shading: Shading | null): Preset {
  const transferFunction: TransferFunction = { unitDistance, color: placed(color), opacity: placed(opacity) };
  return { name, hint, look: { mode: 'dvr', shading, transferFunction } };
}

/** `own` is the look that came with the scene. */
export function presetsOf(volume: VolumeInfo, own: VolumeLook): Preset[] {
  const [low, high] = volume.range;
  const at = (t: number): number => low + t * (high - low);
  const q = (p: number): number => quantile(volume, p);
  const reach = rounded(Math.max(volume.radius, 1e-6) / 60);
  const [skin, soft, hard, hardest] = [q(0.04), q(0.35), q(0.8), q(0.99)];
  return [
    { name: 'Scene', hint: 'As the scene file says', look: own },
    preset('Grey ramp', 'Opacity and brightness grow with the value', reach,
      [[low, 0, 0, 0], [high, 1, 1, 1]], [[low, 0], [skin, 0], [high, 0.35]], null),
    preset('Skin and bone', 'A translucent surface around dense material', reach,
      [[low, 0.35, 0.15, 0.1], [skin, 0.78, 0.5, 0.4], [soft, 0.72, 0.36, 0.26], [hard, 0.95, 0.88, 0.76],
        [high, 1, 1, 0.97]],
      [[skin, 0], [(skin + soft) / 2, 0.05], [soft, 0.02], [hard, 0.06], [hardest, 0.5]], kDefaultShading),
    preset('Bone', 'Only dense material, ivory and shaded', reach,
      [[low, 0.45, 0.25, 0.15], [hard, 0.8, 0.68, 0.5], [hardest, 0.98, 0.95, 0.88]],
      [[(soft + hard) / 2, 0], [hard, 0.12], [hardest, 0.6]],
      { ambient: 0.15, diffuse: 0.8, specular: 0.3, shininess: 30 }),
    preset('X-ray', 'Even and unlit: what lies behind shines through', reach,
      [[low, 1, 1, 1]], [[low, 0], [skin, 0], [at(1), 0.06]], null),
    preset('Cool to warm', 'Two hues about the median, for signed or simulated fields', reach,
      [[low, 0.23, 0.3, 0.75], [q(0.5), 0.87, 0.87, 0.87], [high, 0.71, 0.02, 0.15]],
      [[low, 0], [skin, 0.01], [high, 0.25]], kDefaultShading),
  ];
}
