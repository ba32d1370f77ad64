// SPDX-License-Identifier: Apache-2.0
// The mock's scene: a procedural head-like field of nested shells, so that transfer functions,
// modes and lights have something to show without any data file.

export const kEdge = 96;
const kSpacing = 2;
const kHalf = ((kEdge - 1) * kSpacing) / 2;

const smooth = (low: number, high: number, x: number): number => {
  const t = Math.min(Math.max((x - low) / (high - low), 0), 1);
  return t * t * (3 - 2 * t);
};

function field(x: number, y: number, z: number): number {
  const skull = Math.hypot(x / 62, y / 76, z / 72);
  const grain = 6 * Math.sin(x * 0.33) * Math.sin(y * 0.29) * Math.sin(z * 0.31);
  let value = 55 * (1 - smooth(0.97, 1.05, skull)) + grain * (skull < 1 ? 1 : 0);
  value += 130 * smooth(0.84, 0.88, skull) * (1 - smooth(0.92, 0.95, skull));
  value += 45 * (1 - smooth(0.72, 0.78, skull)) + 16 * Math.sin(skull * 40 + x * 0.2) * (skull < 0.72 ? 1 : 0);
  const eye = Math.min(Math.hypot(x - 24, y + 62, z + 2), Math.hypot(x + 24, y + 62, z + 2));
  value *= smooth(11, 16, eye);
  value += 90 * (1 - smooth(7, 9, eye));
  const jaw = Math.hypot(x / 34, (y + 38) / 34, (z + 58) / 12);
  return value + 110 * (1 - smooth(0.9, 1.05, jaw));
}

export const voxels = new Float32Array(kEdge ** 3);
for (let k = 0, at = 0; k < kEdge; ++k) {
  for (let j = 0; j < kEdge; ++j) {
    for (let i = 0; i < kEdge; ++i, ++at) {
      const value = field(i * kSpacing - kHalf, j * kSpacing - kHalf, k * kSpacing - kHalf);
      voxels[at] = Math.min(Math.max(value, 0), 255);
    }
  }
}

const histogram = new Array<number>(256).fill(0);
for (const value of voxels) ++histogram[Math.round(value)]!;

/** The field at a point in millimetres, trilinear, or -1 outside. */
export function sampleAt(x: number, y: number, z: number): number {
  const [u, v, w] = [(x + kHalf) / kSpacing, (y + kHalf) / kSpacing, (z + kHalf) / kSpacing];
  const last = kEdge - 1;
  if (!(u >= 0 && v >= 0 && w >= 0 && u < last && v < last && w < last)) return -1;
  const [i, j, k] = [u | 0, v | 0, w | 0];
  const [a, b, c] = [u - i, v - j, w - k];
  const at = (k * kEdge + j) * kEdge + i;
  const row = (from: number): number => voxels[from]! + a * (voxels[from + 1]! - voxels[from]!);
  const plane = (from: number): number => row(from) + b * (row(from + kEdge) - row(from));
  return plane(at) + c * (plane(at + kEdge * kEdge) - plane(at));
}

export const volume = {
  name: 'phantom', size: [kEdge, kEdge, kEdge], spacing: [kSpacing, kSpacing, kSpacing], type: 'uint8',
  range: [0, 255], histogram, center: [0, 0, 0], radius: kHalf,
};

export const scene = {
  goldthread: 1,
  image: { width: 512, height: 512, background: [0, 0, 0], colorSpace: 'display' },
  camera: { position: [150, -330, 70], target: [0, 0, 0], up: [0, 0, 1], fovy: 30 },
  lights: [{ type: 'headlight', intensity: 1 }],
  step: 0,
  volumes: [{
    name: 'phantom', mode: 'dvr', shading: { ambient: 0.2, diffuse: 0.7, specular: 0.2, shininess: 20 },
    transferFunction: {
      unitDistance: 2,
      color: [[0, 0.3, 0.1, 0.05], [60, 0.82, 0.5, 0.38], [120, 0.95, 0.85, 0.7], [255, 1, 1, 1]],
      opacity: [[0, 0], [35, 0], [60, 0.03], [110, 0.12], [180, 0.6], [255, 0.9]],
    },
    isosurfaces: [{ value: 110, color: [0.9, 0.8, 0.7], opacity: 1 }],
  }],
};
