// SPDX-License-Identifier: Apache-2.0
import { backoff } from '../../viewer/src/backoff';
import { fitted } from '../../viewer/src/image-size';
import { Latencies, Rate } from '../../viewer/src/latency';
import { hashOf, linkOf, lookOf } from '../../viewer/src/link';
import { sceneOf } from '../../viewer/src/scene';
import { layout } from '../../viewer/src/stage';
import { scene } from '../../viewer/mock/scene';

const { camera, editable } = sceneOf(scene, 'scene');

test('Link.ALookSurvivesItsLink', () => {
  expect(lookOf(hashOf({ camera, editable }))).toEqual({ ok: true, value: { camera, editable } });
});

test('Link.NamesBeyondAsciiAndOddNumbersSurvive', () => {
  const odd = { ...camera, position: [1 / 3, -1e-7, 123456.789012] as const };
  const look = lookOf(hashOf({ camera: odd, editable }));
  expect(look?.ok && look.value.camera.position.map((x, i) => Math.abs(x / odd.position[i]! - 1) < 1e-8)).toEqual([true, true, true]);
});

test('Link.TheTokenStaysBehindUnlessAskedFor', () => {
  const page = 'http://127.0.0.1:8080/?token=secret';
  expect(linkOf(page, { camera, editable }, false)).not.toContain('secret');
  expect(linkOf(page, { camera, editable }, true)).toContain('token=secret');
});

test('Link.ForeignAndDamagedHashesAreNotUsed', () => {
  expect(lookOf('')).toBeNull();
  expect(lookOf('#panel')).toBeNull();
  const good = hashOf({ camera, editable });
  for (const bad of ['#look=', '#look=%%%', good.slice(0, 100), `#look=${'A'.repeat(70000)}`,
    hashOf({ camera: { ...camera, fovy: 0 }, editable }), hashOf({ camera: { ...camera, position: camera.target }, editable })]) {
    expect(lookOf(bad)?.ok, bad.slice(0, 40)).toBe(false);
  }
});

test('Latencies.QuantilesAreByNearestRank', () => {
  const latencies = new Latencies();
  expect(latencies.quantile(0.5)).toBeNull();
  for (let i = 100; i >= 1; --i) latencies.add(i);
  latencies.add(NaN);
  expect(latencies.quantile(0.5)).toBe(50);
  expect(latencies.quantile(0.95)).toBe(95);
  expect(latencies.quantile(1)).toBe(100);
});

test('Latencies.OldValuesAreForgotten', () => {
  const latencies = new Latencies();
  for (let i = 0; i < 1000; ++i) latencies.add(i < 500 ? 1e6 : 10);
  expect(latencies.quantile(1)).toBe(10);
});

test('Rate.CountsTheLastSecond', () => {
  const rate = new Rate();
  for (let time = 0; time <= 2000; time += 100) rate.mark(time);
  expect(rate.perSecond(2000)).toBe(10);
  expect(rate.perSecond(3500)).toBe(0);
});

test('Backoff.DoublesUpToABoundAndSpreads', () => {
  expect([1, 2, 3].map((attempt) => backoff(attempt, 1))).toEqual([500, 1000, 2000]);
  expect(backoff(1000, 1)).toBe(10000);
  expect(backoff(1, 0)).toBe(375);
});

test('ImageSize.FitsTheWindowWithinTheBound', () => {
  expect(fitted(800, 600, 1, 1024)).toEqual({ width: 800, height: 600 });
  expect(fitted(800, 600, 2, 1024)).toEqual({ width: 1024, height: 768 });
  expect(fitted(0, 0, 1, 1024)).toEqual({ width: 16, height: 16 });
  expect(fitted(400, 300, NaN, 1024)).toEqual({ width: 400, height: 300 });
});

test('Stage.APictureOfTheWindowsSizeIsShownPixelForPixel', () => {
  expect(layout(1001, 701, 500.6, 350.4, 2)).toMatchObject({ width: 500.5, height: 350.5 });
  const box = layout(511, 300, 800.3, 300, 1);
  expect(box).toEqual({ left: 145, top: 0, width: 511, height: 300 });
});

test('Stage.OtherPicturesFillTheStageWithTheirShapeKept', () => {
  expect(layout(100, 100, 400, 300, 1)).toEqual({ left: 50, top: 0, width: 300, height: 300 });
});
