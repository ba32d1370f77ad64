// SPDX-License-Identifier: Apache-2.0
import type { ShownPicture } from '../../viewer/src/picture-view';
import type { Phase, Status } from '../../viewer/src/protocol';
import { ErrorHistory, errorCurve, figure, qualityLine, stateOf } from '../../viewer/src/quality';

const picture: ShownPicture = {
  picture: 1, epoch: 1, viewer: 1, serial: 1, width: 8, height: 8, final: false, cineFrame: 0, cineFrames: 0,
  estimatedError: 0.42,
};
const status = (phase: Phase): Status => ({
  epoch: 1, step: 3, samplesPerPixel: 3.1, converged: 0.5, target: 0.25, estimatedError: 0.5, spatialError: null,
  temporalError: null, phase, framesPerSecond: 0, rays: 0, seconds: 0, features: [], kernel: '', ranks: [],
});

test('Quality.OneLineTellsErrorSamplesAndState', () => {
  expect(qualityLine(picture, status('refining'), 0)).toBe('± 0.42 / 255 · 3.1 samples per pixel · sharpening');
  expect(qualityLine({ ...picture, estimatedError: null }, status('moving'), 0)).toBe('3.1 samples per pixel · moving');
  expect(qualityLine(picture, null, 0)).toBe('± 0.42 / 255');
  expect(qualityLine(null, status('moving'), 0)).toBe('');
});

test('Quality.WhatThePageKnowsItselfComesBeforeTheLastStatus', () => {
  expect(stateOf(picture, status('converged'), 1)).toBe('moving');
  expect(stateOf({ ...picture, final: true }, status('refining'), 0)).toBe('converged');
  expect(stateOf({ ...picture, cineFrame: 2, cineFrames: 7 }, status('converged'), 0)).toBe('rocking');
  expect(stateOf({ ...picture, cineFrame: 2, cineFrames: 7 }, status('cine'), 1)).toBe('moving');
  expect(stateOf(null, status('cine'), 0)).toBe('rocking');
  expect(stateOf(null, null, 0)).toBeNull();
});

test('Quality.FiguresKeepTheirWidthWhileTheyFall', () => {
  expect([123.4, 12.34, 9.96, 1.234, 0.996, 0.4, 0.1234, 0.01234, 0, Infinity].map(figure))
    .toEqual(['123', '12', '10', '1.2', '1.0', '0.40', '0.12', '0.012', '0', '–']);
});

test('ErrorHistory.BeginsAnewWithEachInput', () => {
  const history = new ErrorHistory();
  history.add('1.1', 4, 1000);
  history.add('1.1', 2, 1500);
  history.add('1.1', null, 1600);
  expect(history.points).toEqual([{ seconds: 0, error: 4 }, { seconds: 0.5, error: 2 }]);
  history.add('1.2', 3, 2000);
  expect(history.points).toEqual([{ seconds: 0, error: 3 }]);
});

test('ErrorHistory.KeepsTheWholeCourseInBoundedSpace', () => {
  const history = new ErrorHistory();
  for (let i = 1; i <= 100000; ++i) history.add('1.1', 1 / i, i);
  expect(history.points.length).toBeLessThanOrEqual(240);
  expect(history.points[0]).toEqual({ seconds: 0, error: 1 });
  expect(history.points.at(-1)).toEqual({ seconds: 99.999, error: 1e-5 });
});

test('ErrorCurve.FallsFromTheUpperLeftTowardsItsRule', () => {
  const curve = errorCurve([{ seconds: 0, error: 8 }, { seconds: 0.3, error: 4 }, { seconds: 3, error: 2 }], 1);
  expect(curve.points[0]).toEqual([0, 1]);
  expect(curve.points[1]![1]).toBeCloseTo(2 / 3);
  expect(curve.points[2]![0]).toBe(1);
  expect(curve.points[2]![1]).toBeCloseTo(1 / 3);
  expect(curve.rule).toBe(0);
  expect(curve.top).toBe('8.0 / 255');
});

test('ErrorCurve.IsFiniteWhateverTheErrorsAre', () => {
  for (const points of [[], [{ seconds: 0, error: 1 }], [{ seconds: 0, error: 1 }, { seconds: 0, error: 1 }]]) {
    const curve = errorCurve(points, points.length ? 1 : 0);
    expect(curve.points.flat().every(Number.isFinite)).toBe(true);
  }
});
