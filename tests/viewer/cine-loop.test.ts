// SPDX-License-Identifier: Apache-2.0
import { CineLoop } from '../../viewer/src/cine-loop';

const kFrameMs = 1000 / 12;

/** A loop whose frames 1 … count have come in order. */
function full(count = 7): CineLoop<string> {
  const loop = new CineLoop<string>();
  for (let number = 1; number <= count; ++number) loop.put(number, count, `frame ${number}`);
  return loop;
}

/** What is due at `count` times, a frame apart, from the middle of the first one's time. */
function played(loop: CineLoop<string>, count: number, from = 0): (number | null)[] {
  loop.due(from, true);
  return Array.from({ length: count }, (_, i) => loop.due(from + (i + 0.5) * kFrameMs, true));
}

test('CineLoop.NothingIsDueWhileAFrameIsMissing', () => {
  const loop = new CineLoop<string>();
  expect(loop.due(0, true)).toBeNull();
  for (const number of [4, 3, 5, 2, 6, 1]) {
    loop.put(number, 7, 'frame');
    expect(loop.complete).toBe(false);
    expect(loop.due(100 * number, true)).toBeNull();
  }
  loop.put(7, 7, 'frame');
  expect(loop.complete).toBe(true);
  expect(loop.playing).toBe(false);
  expect(loop.due(1000, true)).toBe(7);
  expect(loop.playing).toBe(true);
});

test('CineLoop.GoesThereAndBack', () => {
  expect(played(full(), 26)).toEqual([7, 6, 5, 4, 3, 2, 1, 2, 3, 4, 5, 6, 7, 6, 5, 4, 3, 2, 1, 2, 3, 4, 5, 6, 7, 6]);
});

test('CineLoop.BeginsWithTheFrameThatCameLast', () => {
  const loop = full();
  loop.put(3, 7, 'again');
  expect(played(loop, 3, 5000)).toEqual([3, 4, 5]);
});

test('CineLoop.TwelveFramesArePlayedInASecond', () => {
  const loop = full();
  let changes = 0;
  for (let now = 0, before = loop.due(0, true); now <= 10000; now += 7) {
    const due = loop.due(now, true);
    if (due !== before) ++changes;
    before = due;
  }
  expect(changes).toBeGreaterThanOrEqual(119);
  expect(changes).toBeLessThanOrEqual(120);
});

test('CineLoop.ALatePassSkipsFramesAndKeepsTheTime', () => {
  const loop = full();
  loop.due(0, true);
  expect(loop.due(12.5 * kFrameMs, true)).toBe(7);
  expect(loop.due(13.5 * kFrameMs, true)).toBe(6);
  expect(loop.due(13.4 * kFrameMs, true)).toBe(6);
});

test('CineLoop.WhatMayNotPlayStandsStillAndGoesOnFromThere', () => {
  const loop = full();
  expect(played(loop, 3)).toEqual([7, 6, 5]);
  expect(loop.due(300, false)).toBeNull();
  expect(loop.playing).toBe(false);
  expect(played(loop, 3, 90000)).toEqual([5, 4, 3]);
});

test('CineLoop.AFrameThatComesAgainReplacesItsOlderOneWithoutAHitch', () => {
  const loop = full();
  expect(played(loop, 2)).toEqual([7, 6]);
  expect(loop.put(2, 7, 'sharper')).toEqual(['frame 2']);
  expect(loop.at(2)).toBe('sharper');
  expect(loop.due(2.5 * kFrameMs, true)).toBe(5);
});

test('CineLoop.AnEndedLoopHandsItsFramesBack', () => {
  const loop = full();
  loop.due(0, true);
  expect(loop.clear()).toHaveLength(7);
  expect(loop.frames).toEqual([]);
  expect(loop.playing).toBe(false);
  expect(loop.due(100, true)).toBeNull();
  expect(loop.clear()).toEqual([]);
});

test('CineLoop.AnotherCountIsAnotherLoop', () => {
  const loop = full();
  expect(loop.put(1, 3, 'other')).toHaveLength(7);
  expect(loop.frames).toEqual(['other']);
});

test('CineLoop.OneFrameStandsStill', () => {
  expect(played(full(1), 3)).toEqual([1, 1, 1]);
});
