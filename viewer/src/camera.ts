// SPDX-License-Identifier: Apache-2.0
// The camera and how gestures move it, as pure functions with the habits of VTK's trackball-camera
// style: azimuth about the view up, elevation about the view's right, up made orthogonal after each
// step. World units are millimetres, angles degrees, drags fractions of the picture's height with y
// growing downwards. No gesture, however large or empty, makes a camera that is not finite.

import { add, anyPerpendicular, cross, dot, length, normalized, rotated, scale, subtract, type Vec3 } from './vector';

export interface Camera {
  readonly position: Vec3;
  readonly target: Vec3;
  readonly up: Vec3;
  /** The full vertical angle of view in degrees. */
  readonly fovy: number;
}

/** VTK: a drag across the whole window turns by 200 degrees. */
const kDegreesPerWindow = 200;
/** VTK: dragging from the centre to the edge zooms by 1.1^10. */
const kDollyBase = 1.1;
const kDollyMotion = 10;
/** Distances beyond this many times the reference would leave no digits to turn with. */
const kMaxZoomRatio = 1e4;

const radians = (degrees: number): number => (degrees * Math.PI) / 180;

export const distance = (camera: Camera): number => length(subtract(camera.position, camera.target));

export const direction = (camera: Camera): Vec3 =>
  normalized(subtract(camera.target, camera.position));

/** The view's right, up and forward: orthonormal even for a degenerate camera. */
export function frame(camera: Camera): { right: Vec3; up: Vec3; forward: Vec3 } {
  const forward = direction(camera);
  const side = cross(forward, camera.up);
  const right = length(side) > 1e-9 * length(camera.up) && length(side) > 0
    ? normalized(side)
    : anyPerpendicular(forward);
  return { right, up: cross(right, forward), forward };
}

/** Turns about the target: `azimuth` about the view up, `elevation` about the right, in degrees. */
export function orbit(camera: Camera, azimuth: number, elevation: number): Camera {
  if (!Number.isFinite(azimuth) || !Number.isFinite(elevation)) return camera;
  const { up } = frame(camera);
  const arm = rotated(subtract(camera.position, camera.target), up, radians(azimuth));
  const forward = normalized(scale(arm, -1));
  const right = cross(forward, up);
  const turned = rotated(arm, right, radians(-elevation));
  return {
    ...camera,
    position: add(camera.target, turned),
    up: normalized(rotated(up, right, radians(-elevation)), up),
  };
}

/** Turns the picture about its centre by `angle` degrees, clockwise. */
export function roll(camera: Camera, angle: number): Camera {
  if (!Number.isFinite(angle)) return camera;
  const { up, forward } = frame(camera);
  return { ...camera, up: normalized(rotated(up, forward, radians(-angle)), up) };
}

/** A drag by (dx, dy) picture heights with the turning hand: the object follows the hand. */
export const dragOrbit = (camera: Camera, dx: number, dy: number): Camera =>
  orbit(camera, -dx * kDegreesPerWindow, dy * kDegreesPerWindow);

/** Moves camera and target together so that the target's plane follows the hand. */
export function pan(camera: Camera, dx: number, dy: number): Camera {
  if (!Number.isFinite(dx) || !Number.isFinite(dy)) return camera;
  const { right, up } = frame(camera);
  const height = 2 * distance(camera) * Math.tan(radians(camera.fovy) / 2);
  const shift = add(scale(right, -dx * height), scale(up, dy * height));
  return { ...camera, position: add(camera.position, shift), target: add(camera.target, shift) };
}

/** Brings the camera nearer by `factor` (> 1 nearer), bounded about `reference` millimetres. */
export function dolly(camera: Camera, factor: number, reference: number): Camera {
  if (!(factor > 0) || !Number.isFinite(factor)) return camera;
  const old = distance(camera);
  if (!(old > 0)) return camera;
  const base = reference > 0 ? reference : old;
  const next = Math.min(Math.max(old / factor, base / kMaxZoomRatio), base * kMaxZoomRatio);
  const arm = subtract(camera.position, camera.target);
  return { ...camera, position: add(camera.target, scale(arm, next / old)) };
}

/** VTK's zoom factor of a drag by `dy` picture heights (upwards is nearer). */
export const dragFactor = (dy: number): number => kDollyBase ** (kDollyMotion * -dy * 2);

/** The zoom factor of one notch of the wheel, and parts of it. */
export const wheelFactor = (notches: number): number =>
  kDollyBase ** (kDollyMotion * 0.2 * Math.min(Math.max(notches, -10), 10));

/** Keeps the direction and frames the sphere (VTK's `r`). */
export function framed(camera: Camera, center: Vec3, radius: number): Camera {
  const { up, forward } = frame(camera);
  const reach = (radius > 0 ? radius : 1) / Math.sin(radians(camera.fovy) / 2);
  return { ...camera, target: center, position: subtract(center, scale(forward, reach)), up };
}

/** Looks at the sphere's centre along `forward` (anatomical directions of LPS space). */
export function lookingAlong(camera: Camera, center: Vec3, radius: number, forward: Vec3, up: Vec3): Camera {
  const turned = { ...camera, target: center, position: subtract(center, forward), up };
  return framed(turned, center, radius);
}

export function isUsable(camera: Camera): boolean {
  const numbers = [...camera.position, ...camera.target, ...camera.up, camera.fovy];
  return numbers.every(Number.isFinite) && distance(camera) > 0 &&
    Math.abs(dot(camera.up, camera.up)) > 0 && camera.fovy > 0 && camera.fovy < 180;
}
