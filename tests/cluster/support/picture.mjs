// SPDX-License-Identifier: Apache-2.0
// 8-bit PNG files, decoded here so that the tests do not trust the library that wrote them.

import { readFileSync } from 'node:fs';
import { inflateSync } from 'node:zlib';

const kSignature = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
const kChannels = { 0: 1, 2: 3, 6: 4 };

function* chunksOf(file) {
  if (!file.subarray(0, 8).equals(kSignature)) throw new Error('no PNG file');
  for (let at = 8; at < file.length;) {
    const length = file.readUInt32BE(at);
    yield { type: file.toString('latin1', at + 4, at + 8), data: file.subarray(at + 8, at + 8 + length) };
    at += 12 + length;
  }
}

function paeth(left, up, corner) {
  const estimate = left + up - corner;
  const [a, b, c] = [left, up, corner].map((value) => Math.abs(estimate - value));
  return a <= b && a <= c ? left : b <= c ? up : corner;
}

/** Undoes the filters of the PNG specification, row by row. */
function unfilter(packed, height, stride, step) {
  const rows = Buffer.alloc(height * stride);
  for (let y = 0; y < height; ++y) {
    const filter = packed[y * (stride + 1)];
    for (let i = 0; i < stride; ++i) {
      const at = y * stride + i;
      const left = i >= step ? rows[at - step] : 0;
      const up = y > 0 ? rows[at - stride] : 0;
      const corner = i >= step && y > 0 ? rows[at - stride - step] : 0;
      const guess = [0, left, up, (left + up) >> 1, paeth(left, up, corner)][filter];
      rows[at] = packed[y * (stride + 1) + 1 + i] + guess;
    }
  }
  return rows;
}

function textOf({ type, data }) {
  const end = data.indexOf(0);
  const key = data.toString('latin1', 0, end);
  if (type === 'tEXt') return [key, data.toString('latin1', end + 1)];
  if (type === 'zTXt') return [key, inflateSync(data.subarray(end + 2)).toString('latin1')];
  const compressed = data[end + 1] === 1;
  const begin = data.indexOf(0, data.indexOf(0, end + 3) + 1) + 1;
  const text = data.subarray(begin);
  return [key, (compressed ? inflateSync(text) : text).toString('utf8')];
}

/** {width, height, rgb (rows from the top, 3 bytes a pixel), texts} */
export function readPng(path) {
  const chunks = [...chunksOf(readFileSync(path))];
  const header = chunks[0].data;
  const [width, height] = [header.readUInt32BE(0), header.readUInt32BE(4)];
  if (header[8] !== 8 || header[12] !== 0) throw new Error('only 8 bits, not interlaced');
  const channels = kChannels[header[9]];
  const packed = inflateSync(Buffer.concat(chunks.filter(({ type }) => type === 'IDAT').map(({ data }) => data)));
  const rows = unfilter(packed, height, width * channels, channels);
  const rgb = Buffer.alloc(3 * width * height);
  for (let i = 0; i < width * height; ++i) {
    for (let c = 0; c < 3; ++c) rgb[3 * i + c] = rows[channels * i + (channels >= 3 ? c : 0)];
  }
  const texts = Object.fromEntries(chunks.filter(({ type }) => /^(tEXt|zTXt|iTXt)$/.test(type)).map(textOf));
  return { width, height, rgb, texts };
}

/** How two pictures of one size differ: pixels, the greatest and the mean difference of a channel, 0 … 255. */
export function difference(a, b) {
  if (a.width !== b.width || a.height !== b.height) {
    throw new Error(`${a.width}×${a.height} is not ${b.width}×${b.height}`);
  }
  let pixels = 0, greatest = 0, sum = 0;
  for (let i = 0; i < a.rgb.length; i += 3) {
    const deltas = [0, 1, 2].map((c) => Math.abs(a.rgb[i + c] - b.rgb[i + c]));
    greatest = Math.max(greatest, ...deltas);
    sum += deltas[0] + deltas[1] + deltas[2];
    if (Math.max(...deltas) > 0) ++pixels;
  }
  return { pixels, greatest, mean: sum / a.rgb.length };
}

/** The share of pixels that are not the colour of the top left one. */
export function covered({ rgb }) {
  let count = 0;
  for (let i = 0; i < rgb.length; i += 3) {
    if (rgb[i] !== rgb[0] || rgb[i + 1] !== rgb[1] || rgb[i + 2] !== rgb[2]) ++count;
  }
  return (3 * count) / rgb.length;
}
