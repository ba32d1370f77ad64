// SPDX-License-Identifier: Apache-2.0
import { viridis, workerColor } from '../../viewer/src/load/colors';
import { bytesText, imbalance, timeText } from '../../viewer/src/load/measures';
import type { RankLoad } from '../../viewer/src/load/messages';
import { dearest } from '../../viewer/src/load/tile-overlay';
import { binPlace, kSeconds } from '../../viewer/src/load/timeline';
import { decodeMessage } from '../../viewer/src/protocol';
import { loadOf, tilesOf } from '../../viewer/mock/load';

const decoded = (message: unknown) => decodeMessage(JSON.stringify(message));

const rank = { rank: 2, role: 'worker', lost: false, busy: 0.5, view: 0.25, share: 'A_f', age: 12.5, error: 0.25 };
const bytes = { kind: 'Samples', messages: 3, total: 4000, perSecond: 1000 };
const load = { type: 'load', bin: 50, ranks: [rank], bytes: [bytes] };
const tiles = { type: 'tiles', epoch: 7, width: 96, height: 64, tile: [64, 64], tiles: [0, 0, 64, 64, 2, 1.5, 64, 0, 32, 64, 3, 0.5] };

const worker = (number: number, busy: number, more: Partial<RankLoad> = {}): RankLoad =>
  ({ rank: number, role: 'worker', lost: false, busy, view: null, share: [], age: 0, error: 0, ...more });

/** CIE 1976 lightness of 8-bit sRGB, from its definition. */
function lightness(rgb: readonly number[]): number {
  const linear = rgb.map((value) => (value / 255 <= 0.04045 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4));
  const y = 0.2126 * linear[0]! + 0.7152 * linear[1]! + 0.0722 * linear[2]!;
  return y > (6 / 29) ** 3 ? 116 * Math.cbrt(y) - 16 : (29 / 3) ** 3 * y;
}

test('Load.ItIsDecoded', () => {
  expect(decoded(load)).toEqual({ ok: true, value: { type: 'load', load: {
    bin: 50, bytes: [bytes], ranks: [{ ...rank, share: [0, 1, 31 / 63] }] } } });
  const { view, ...other } = rank;
  expect(view).toBe(0.25);
  expect(decoded({ ...load, ranks: [other] })).toMatchObject({ value: { load: { ranks: [{ view: null }] } } });
});

test('Load.TilesAreDecodedInSixes', () => {
  expect(decoded(tiles)).toEqual({ ok: true, value: { type: 'tiles', tiles: {
    epoch: 7, width: 96, height: 64, tile: [64, 64],
    tiles: [{ x: 0, y: 0, width: 64, height: 64, rank: 2, cost: 1.5 }, { x: 64, y: 0, width: 32, height: 64, rank: 3, cost: 0.5 }] } } });
});

test('Load.WhatHasAnotherFormChangesNothing', () => {
  for (const bad of [
    { ...load, bin: 0 }, { ...load, ranks: {} }, { ...load, bytes: undefined }, { ...load, ranks: [{ ...rank, busy: '1' }] },
    { ...load, ranks: [{ ...rank, share: 'A é' }] }, { ...load, ranks: [{ ...rank, age: null }] }, { ...load, bytes: [{ ...bytes, total: -1 }] },
    { ...tiles, tiles: [1, 2, 3] }, { ...tiles, width: 0 }, { ...tiles, tile: [64] }, { ...tiles, tiles: [0, 0, 64, 64, 2, null] },
  ]) expect(decoded(bad).ok, JSON.stringify(bad)).toBe(false);
});

test('Load.TheMockSpeaksTheProtocol', () => {
  expect(decoded(loadOf(123456, true)).ok).toBe(true);
  const message = decoded(tilesOf(3, 200, 130));
  if (!message.ok || message.value.type !== 'tiles') throw new Error('no tiles');
  expect(message.value.tiles.tiles.reduce((sum, { width, height }) => sum + width * height, 0)).toBe(200 * 130);
});

test('Load.ImbalanceIsTheMostOverTheMeanOfTheWorkersThatLive', () => {
  const ranks = [worker(2, 0.9), worker(3, 0.6), worker(4, 0.3), worker(5, 1, { lost: true }), worker(0, 1, { role: 'master' })];
  expect(imbalance(ranks, 'second')).toEqual({ excess: expect.closeTo(0.5, 12), busiest: 2 });
  expect(imbalance([worker(2, 0.4)], 'second')).toEqual({ excess: expect.closeTo(0, 12), busiest: 2 });
  expect(imbalance([worker(2, 0), worker(3, 0)], 'second')).toBeNull();
  expect(imbalance(ranks, 'view')).toBeNull();
  expect(imbalance([worker(2, 1, { view: 1 }), worker(3, 0, { view: 3 })], 'view')).toEqual({ excess: expect.closeTo(0.5, 12), busiest: 3 });
});

test('Load.BinsOfOneMomentLieAboveEachOtherWhateverTheirAge', () => {
  const full = { bin: 50 };
  const share = Array<number>(128).fill(1);
  const [from, to] = binPlace(full, { share, age: 0 }, 127);
  expect(to).toBe(1);
  expect((to - from) * kSeconds * 1000).toBeCloseTo(50, 9);
  // A rank whose newest bin ended 250 ms earlier: its newest lies on the other's sixth from the end.
  expect(binPlace(full, { share, age: 250 }, 127)[1]).toBeCloseTo(binPlace(full, { share, age: 0 }, 122)[1], 12);
});

test('Load.TheDearestTileIsThatOfTheMostTimePerPixel', () => {
  const message = decoded({ ...tiles, tiles: [0, 0, 64, 64, 2, 1.5, 64, 0, 32, 64, 3, 1] });
  if (!message.ok || message.value.type !== 'tiles') throw new Error('no tiles');
  expect(dearest(message.value.tiles)).toBe(2);
});

test('Load.NumbersAreForPeople', () => {
  expect([0, 999, 1000, 1234, 99949, 999499, 999500, 2.5e9].map(bytesText))
    .toEqual(['0 B', '999 B', '1.00 kB', '1.23 kB', '99.9 kB', '999 kB', '1.00 MB', '2.50 GB']);
  expect([0, 0.0454, 1.234, 45.67, 999, 1500].map(timeText)).toEqual(['0 µs', '45 µs', '1.23 ms', '45.7 ms', '999 ms', '1.50 s']);
});

test('Viridis.LightnessGrowsInAStraightLine', () => {
  const steps = Array.from({ length: 101 }, (_, i) => lightness(viridis(i / 100)));
  expect(steps[100]! - steps[0]!).toBeGreaterThan(75);
  steps.forEach((step, i) => {
    if (i > 0) expect(step, `step ${i}`).toBeGreaterThan(steps[i - 1]!);
    expect(Math.abs(step - steps[0]! - (i / 100) * (steps[100]! - steps[0]!)), `step ${i}`).toBeLessThan(2.5);
  });
  expect(viridis(-1)).toEqual([0x44, 0x01, 0x54]);
  expect(viridis(2)).toEqual([0xfd, 0xe7, 0x25]);
});

test('WorkerColor.HundredsOfWorkersHaveColoursOfTheirOwn', () => {
  expect(new Set(Array.from({ length: 300 }, (_, i) => workerColor(i))).size).toBeGreaterThan(290);
});
