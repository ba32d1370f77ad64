// SPDX-License-Identifier: Apache-2.0
// The mock's renderer: a plain ray march at a given pixel spacing, good enough to try controls on.

import { direction, distance, frame, type Camera } from '../src/camera';
import { colorAt, opacityAt } from '../src/transfer-function';
import type { Editable } from '../src/scene';
import { normalized, type Vec3 } from '../src/vector';
import { sampleAt, volume } from './scene';

/** Coarse levels march coarsely too, to keep up with the hand. */
const stepOf = (spacing: number): number => (spacing > 2 ? 6 : 2.5);

interface Tables { color: Vec3[]; opacity: Float32Array }

function tablesOf({ volume: look }: Editable, step: number): Tables {
  const values = Array.from({ length: 256 }, (_, i) => i);
  const { transferFunction: tf } = look;
  const color = values.map((v) => colorAt(tf.color, v));
  const opacity = Float32Array.from(values, (v) => 1 - (1 - opacityAt(tf.opacity, v)) ** (step / tf.unitDistance));
  return { color, opacity };
}

/** Lit brightness at a point from the field's gradient and a headlight along `d`. */
function shade(editable: Editable, x: number, y: number, z: number, d: Vec3): [number, number] {
  const { shading } = editable.volume;
  if (!shading) return [1, 0];
  const h = 3;
  const n = normalized([sampleAt(x + h, y, z) - sampleAt(x - h, y, z), sampleAt(x, y + h, z) - sampleAt(x, y - h, z),
    sampleAt(x, y, z + h) - sampleAt(x, y, z - h)], [0, 0, 0]);
  const facing = Math.abs(n[0] * d[0] + n[1] * d[1] + n[2] * d[2]);
  const light = editable.lights.reduce((sum, l) => sum + l.intensity, 0);
  return [shading.ambient + light * shading.diffuse * facing, light * shading.specular * facing ** shading.shininess];
}

function cast(editable: Editable, tables: Tables, o: Vec3, d: Vec3, near: number, far: number, step: number): Vec3 {
  let [r, g, b, through, most] = [0, 0, 0, 1, -1];
  const { mode, isosurfaces } = editable.volume;
  const add = (color: Vec3, alpha: number, x: number, y: number, z: number): void => {
    const [lit, shine] = shade(editable, x, y, z, d);
    const weight = through * alpha;
    r += weight * (color[0] * lit + shine);
    g += weight * (color[1] * lit + shine);
    b += weight * (color[2] * lit + shine);
    through *= 1 - alpha;
  };
  let before = -1;
  for (let t = near; t < far && through > 0.01; t += step) {
    const [x, y, z] = [o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]];
    const value = sampleAt(x, y, z);
    if (value >= 0) {
      most = Math.max(most, value);
      if (mode !== 'mip') {
        for (const iso of isosurfaces) {
          if (before >= 0 && (before < iso.value) !== (value < iso.value)) add(iso.color, iso.opacity, x, y, z);
        }
      }
      const alpha = tables.opacity[value | 0]!;
      if (mode === 'dvr' && alpha > 0.0005) add(tables.color[value | 0]!, alpha, x, y, z);
    }
    before = value;
  }
  if (mode === 'mip' && most >= 0) return tables.color[most | 0]!;
  const { background } = editable;
  return [r + through * background[0], g + through * background[1], b + through * background[2]];
}

/** RGB rows from the top, by rays at that place of each square; a generator that yields after each row of samples. */
export function* rendered(camera: Camera, editable: Editable, width: number, height: number, spacing: number,
  [along, down]: [number, number] = [0.5, 0.5]): Generator<null, Uint8Array> {
  const pixels = new Uint8Array(width * height * 3);
  const step = stepOf(spacing);
  const tables = tablesOf(editable, step);
  const { right, up } = frame(camera);
  const forward = direction(camera);
  const half = Math.tan((camera.fovy * Math.PI) / 360);
  const reach = distance(camera);
  const [near, far] = [Math.max(0, reach - volume.radius * 1.5), reach + volume.radius * 1.5];
  for (let y = 0; y < height; y += spacing) {
    for (let x = 0; x < width; x += spacing) {
      const u = ((2 * (x + spacing * along) - width) / height) * half;
      const v = (1 - (2 * (y + spacing * down)) / height) * half;
      const ray = normalized([0, 1, 2].map((i) => forward[i]! + u * right[i]! + v * up[i]!) as unknown as Vec3);
      const color = cast(editable, tables, camera.position, ray, near, far, step).map((c) => Math.min(c, 1) * 255);
      for (let j = y; j < Math.min(y + spacing, height); ++j) {
        for (let i = x; i < Math.min(x + spacing, width); ++i) pixels.set(color, (j * width + i) * 3);
      }
    }
    yield null;
  }
  return pixels;
}
