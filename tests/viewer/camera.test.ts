// SPDX-License-Identifier: Apache-2.0
import {
  direction, distance, dolly, dragFactor, dragOrbit, frame, framed, isUsable, lookingAlong, orbit, pan, roll, wheelFactor,
  type Camera,
} from '../../viewer/src/camera';
import { dot, length, subtract, type Vec3 } from '../../viewer/src/vector';

const camera: Camera = { position: [30, -500, 120], target: [3, -4, 20], up: [0, 0, 1], fovy: 30 };
const drags = [[0.1, 0], [0, 0.1], [-0.37, 0.22], [2.5, -1.75]] as const;

function expectNear(a: Vec3, b: Vec3, digits = 9): void {
  a.forEach((x, i) => expect(x).toBeCloseTo(b[i]!, digits));
}

test('Camera.AFullTurnReturns', () => {
  let turned = camera;
  for (let i = 0; i < 72; ++i) turned = orbit(turned, 5, 0);
  expectNear(turned.position, camera.position, 8);
  expectNear(turned.up, frame(camera).up, 8);
  let tumbled = camera;
  for (let i = 0; i < 72; ++i) tumbled = orbit(tumbled, 0, 5);
  expectNear(tumbled.position, camera.position, 8);
});

test('Camera.AQuarterAzimuthLooksFromTheSide', () => {
  const front: Camera = { position: [0, -10, 0], target: [0, 0, 0], up: [0, 0, 1], fovy: 30 };
  expectNear(orbit(front, 90, 0).position, [10, 0, 0]);
  expectNear(orbit(front, 0, 90).position, [0, 0, 10]);
});

test('Camera.TheObjectFollowsTheHand', () => {
  const front: Camera = { position: [0, -10, 0], target: [0, 0, 0], up: [0, 0, 1], fovy: 30 };
  // Screen right is +x here: what faces the camera moves right when the camera moves to the left.
  expect(dragOrbit(front, 0.1, 0).position[0]).toBeLessThan(0);
  // Dragging down shows more of the top.
  expect(dragOrbit(front, 0, 0.1).position[2]).toBeGreaterThan(0);
  expect(pan(front, 0.1, 0).target[0]).toBeLessThan(0);
  expect(pan(front, 0, 0.1).target[2]).toBeGreaterThan(0);
});

test('Camera.TurningKeepsTheDistanceAndTheTarget', () => {
  for (const [dx, dy] of drags) {
    let turned = camera;
    for (let i = 0; i < 500; ++i) turned = dragOrbit(turned, dx, dy);
    expect(distance(turned)).toBeCloseTo(distance(camera), 6);
    expect(turned.target).toEqual(camera.target);
  }
});

test('Camera.TheFrameStaysOrthonormal', () => {
  let turned = camera;
  for (const [dx, dy] of drags) turned = roll(dragOrbit(turned, dx, dy), 17);
  const { right, up, forward } = frame(turned);
  for (const axis of [right, up, forward]) expect(length(axis)).toBeCloseTo(1, 12);
  for (const [a, b] of [[right, up], [up, forward], [forward, right]] as const) expect(dot(a, b)).toBeCloseTo(0, 12);
  expect(dot(turned.up, direction(turned))).toBeCloseTo(0, 12);
});

test('Camera.EmptyGesturesChangeNothingButTheRoundOff', () => {
  for (const still of [dragOrbit(camera, 0, 0), pan(camera, 0, 0), roll(camera, 0), dolly(camera, dragFactor(0), 100)]) {
    expectNear(still.position, camera.position);
    expectNear(still.target, camera.target);
    expect(isUsable(still)).toBe(true);
  }
  expect(wheelFactor(0)).toBe(1);
});

test('Camera.ZoomKeepsTheDirectionAndUndoesItself', () => {
  const near = dolly(camera, wheelFactor(3), 100);
  expect(distance(near)).toBeLessThan(distance(camera));
  expectNear(direction(near), direction(camera));
  expectNear(dolly(near, wheelFactor(-3), 100).position, camera.position, 8);
});

test('Camera.ZoomIsBounded', () => {
  let near = camera;
  for (let i = 0; i < 1000; ++i) near = dolly(near, wheelFactor(10), 100);
  expect(isUsable(near)).toBe(true);
  expect(distance(near)).toBeGreaterThan(0);
  let far = camera;
  for (let i = 0; i < 1000; ++i) far = dolly(far, wheelFactor(-10), 100);
  expect(isUsable(far)).toBe(true);
});

test('Camera.APanMovesTheTargetsPlaneWithTheHand', () => {
  const moved = pan(camera, 0.25, 0);
  const height = 2 * distance(camera) * Math.tan((camera.fovy * Math.PI) / 360);
  expect(length(subtract(moved.target, camera.target))).toBeCloseTo(0.25 * height, 9);
  expectNear(direction(moved), direction(camera));
});

test('Camera.FramingPutsTheSphereExactlyInTheAngleOfView', () => {
  const all = framed(camera, [7, 8, 9], 90);
  expect(all.target).toEqual([7, 8, 9]);
  expect(Math.asin(90 / distance(all)) * (360 / Math.PI)).toBeCloseTo(camera.fovy, 9);
  expectNear(direction(all), direction(camera));
});

test('Camera.AStandardViewLooksAlongItsAxis', () => {
  const top = lookingAlong(camera, [0, 0, 0], 10, [0, 0, -1], [0, -1, 0]);
  expectNear(direction(top), [0, 0, -1]);
  expectNear(frame(top).up, [0, -1, 0]);
});

test('Camera.DegenerateCamerasStayFinite', () => {
  const along: Camera = { position: [0, 0, 10], target: [0, 0, 0], up: [0, 0, 1], fovy: 30 };
  const nowhere: Camera = { position: [0, 0, 0], target: [0, 0, 0], up: [0, 0, 0], fovy: 30 };
  for (const bad of [along, nowhere]) {
    for (const moved of [dragOrbit(bad, 0.3, 0.2), pan(bad, 0.1, 0.1), dolly(bad, 2, 10), roll(bad, 10), framed(bad, [0, 0, 0], 5)]) {
      expect([...moved.position, ...moved.target, ...moved.up].every(Number.isFinite)).toBe(true);
    }
  }
  for (const wrong of [NaN, Infinity]) {
    expect(dragOrbit(camera, wrong, 0)).toEqual(camera);
    expect(pan(camera, wrong, 0)).toEqual(camera);
    expect(dolly(camera, wrong, 100)).toEqual(camera);
  }
});
