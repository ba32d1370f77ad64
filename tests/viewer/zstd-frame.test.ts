// SPDX-License-Identifier: Apache-2.0
import { decodeZstd, rgbaOfRgb } from '../../viewer/src/zstd-frame';
import { rawZstd } from '../../viewer/mock/encode';
import { frame, kHeight, kWidth, pattern } from './zstd-fixture';

const kBytes = kWidth * kHeight * 3;

test('Zstd.AFrameOfLibzstdGivesItsBytes', () => {
  expect(decodeZstd(frame, kBytes)).toEqual({ ok: true, value: pattern() });
});

test('Zstd.SeveralBlocksGiveTheirBytes', () => {
  const data = Uint8Array.from({ length: 300000 }, (_, i) => (i * 31) & 255);
  const decoded = decodeZstd(rawZstd(data), data.length);
  expect(decoded.ok && Buffer.compare(decoded.value, data)).toBe(0);
});

test('Zstd.AFrameOfAnotherSizeIsRefused', () => {
  expect(decodeZstd(frame, kBytes + 3).ok).toBe(false);
  expect(decodeZstd(frame, kBytes - 3).ok).toBe(false);
});

test('Zstd.EveryTruncationIsRefused', () => {
  for (let length = 0; length < frame.length; length += 7) {
    expect(decodeZstd(frame.slice(0, length), kBytes).ok).toBe(false);
  }
});

test('Zstd.TrailingBytesAreRefused', () => {
  expect(decodeZstd(Uint8Array.from([...frame, 0]), kBytes).ok).toBe(false);
  expect(decodeZstd(Uint8Array.from([...frame, ...frame]), kBytes).ok).toBe(false);
});

test('Zstd.AHugeDeclaredSizeAllocatesNothing', () => {
  const huge = frame.slice();
  huge[4] = 0xe0;
  huge.fill(0xff, 5, 13);
  expect(decodeZstd(huge, kBytes).ok).toBe(false);
});

test('Zstd.DamagedBytesGiveAResultAndNeverThrow', () => {
  for (let at = 0; at < frame.length; at += 3) {
    const damaged = frame.slice();
    damaged[at]! ^= 0x55;
    const decoded = decodeZstd(damaged, kBytes);
    if (decoded.ok) expect(decoded.value.length).toBe(kBytes);
  }
});

test('Zstd.RgbBecomesOpaqueRgba', () => {
  expect([...rgbaOfRgb(Uint8Array.of(1, 2, 3, 253, 254, 255))]).toEqual([1, 2, 3, 255, 253, 254, 255, 255]);
});
