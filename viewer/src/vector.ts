// SPDX-License-Identifier: Apache-2.0
// Vectors of three doubles as immutable tuples. A library is not used here on purpose: the usual
// ones compute in 32 bits and write into their arguments, and a camera must survive thousands of
// small turns without drifting from what the server holds.

export type Vec3 = readonly [number, number, number];

export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a: Vec3, s: number): Vec3 => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const length = (a: Vec3): number => Math.hypot(a[0], a[1], a[2]);

export function cross(a: Vec3, b: Vec3): Vec3 {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** The unit vector along `a`, or `fallback` where `a` has no direction. */
export function normalized(a: Vec3, fallback: Vec3 = [0, 0, 1]): Vec3 {
  const size = length(a);
  return size > 0 && Number.isFinite(size) ? scale(a, 1 / size) : fallback;
}

/** Turns `a` about the unit vector `axis` by `angle` radians, right-handed (Rodrigues). */
export function rotated(a: Vec3, axis: Vec3, angle: number): Vec3 {
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  return add(add(scale(a, c), scale(cross(axis, a), s)), scale(axis, dot(axis, a) * (1 - c)));
}

/** A unit vector at right angles to the unit vector `a`. */
export function anyPerpendicular(a: Vec3): Vec3 {
  return normalized(cross(a, Math.abs(a[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0]));
}
