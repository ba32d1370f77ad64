// SPDX-License-Identifier: Apache-2.0
// The mock's golden thread: first ever finer squares, then ever more rays in each pixel, with an
// estimated error that falls as it would.

import type { Camera } from '../src/camera';
import type { Editable } from '../src/scene';
import { rendered } from './render';

export interface Refined {
  readonly rgb: Uint8Array;
  readonly width: number;
  readonly height: number;
  readonly step: number;
  readonly samplesPerPixel: number;
  /** Root mean square in 1/255. */
  readonly error: number;
}

export const kTarget = 1;
const kErrorOfOneRay = 1.7;

/** Where in a pixel its n-th ray goes: evenly spread, the first one in the middle. */
const jitter = (n: number): [number, number] => [(0.5 + n * 0.7549) % 1, (0.5 + n * 0.5698) % 1];

/** Ever better pictures; yields null between two rows, so that others get their turn. */
export function* refined(camera: Camera, editable: Editable, width: number, height: number): Generator<Refined | null> {
  let step = 0;
  for (const spacing of [8, 4, 2]) {
    const rgb = yield* rendered(camera, editable, width, height, spacing);
    yield { rgb, width, height, step: ++step, samplesPerPixel: 1 / spacing ** 2, error: kErrorOfOneRay * spacing };
  }
  const sum = new Float32Array(width * height * 3);
  for (let rays = 1; ; ++rays) {
    const pass = yield* rendered(camera, editable, width, height, 1, jitter(rays - 1));
    pass.forEach((value, i) => { sum[i]! += value; });
    const rgb = Uint8Array.from(sum, (value) => Math.round(value / rays));
    yield { rgb, width, height, step: ++step, samplesPerPixel: rays, error: kErrorOfOneRay / Math.sqrt(rays) };
  }
}
