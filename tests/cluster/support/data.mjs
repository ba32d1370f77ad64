// SPDX-License-Identifier: Apache-2.0
// Small volumes and scenes that the tests write: bumpy enough that a misplaced sample shows.

import { writeFileSync } from 'node:fs';
import { inScratch } from './program.mjs';

const kSize = [24, 20, 16];

/** The value at a voxel, 0 … 255: a ball with ripples, without any symmetry. */
function bumps(x, y, z) {
  const distance = Math.hypot(x - 11, y - 9.5, z - 8);
  return Math.round(Math.max(0, Math.min(255, 255 - 22 * distance + 40 * Math.sin(1.3 * x) * Math.cos(y + z))));
}

function voxels([width, height, depth], value) {
  const bytes = Buffer.alloc(width * height * depth);
  for (let z = 0; z < depth; ++z) {
    for (let y = 0; y < height; ++y) {
      for (let x = 0; x < width; ++x) bytes[x + width * (y + height * z)] = value(x, y, z);
    }
  }
  return bytes;
}

/** An NRRD file of the bumps; `directions` are the steps of the three axes in millimetres, LPS. */
export function writeNrrd(name, { origin = [-11.5, -9.5, -7.5], directions = [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
                                  size = kSize, value = bumps } = {}) {
  const vector = (v) => `(${v.join(',')})`;
  const header = ['NRRD0004', 'type: uint8', 'dimension: 3', 'space: left-posterior-superior',
    `sizes: ${size.join(' ')}`, `space directions: ${directions.map(vector).join(' ')}`,
    `space origin: ${vector(origin)}`, 'kinds: domain domain domain', 'encoding: raw', '', ''];
  const file = inScratch(name);
  writeFileSync(file, Buffer.concat([Buffer.from(header.join('\n')), voxels(size, value)]));
  return file;
}

export const lit = { ambient: 0.2, diffuse: 0.7, specular: 0.3, shininess: 20 };
export const surfaces = [{ value: 90, color: [0.9, 0.7, 0.5], opacity: 0.5 }, { value: 180, color: [0.4, 0.6, 0.9], opacity: 1 }];
export const camera = { position: [25, -45, 20], target: [0, 0, 0], up: [0, 0, 1], fovy: 30 };

/** A scene of `volume`; keys of `volumeKeys` and `sceneKeys` replace or add. */
export function sceneOf(volume, volumeKeys = {}, sceneKeys = {}) {
  return {
    goldthread: 1,
    image: { width: 96, height: 80, background: [0.1, 0.2, 0.3] },
    camera,
    lights: [{ type: 'headlight', intensity: 1 }],
    volumes: [{
      name: 'bumps', file: volume, mode: 'dvr',
      transferFunction: {
        unitDistance: 1,
        color: [[0, 0, 0, 0.3], [90, 0.9, 0.3, 0.1], [255, 1, 1, 0.8]],
        opacity: [[0, 0], [40, 0], [120, 0.15], [255, 0.7]],
      },
      ...volumeKeys,
    }],
    ...sceneKeys,
  };
}

export function writeJson(name, value) {
  const file = inScratch(name);
  writeFileSync(file, typeof value === 'string' ? value : JSON.stringify(value));
  return file;
}
