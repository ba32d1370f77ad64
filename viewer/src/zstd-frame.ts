// SPDX-License-Identifier: Apache-2.0
// Decodes the payload of a lossless region: exactly one zstd frame (RFC 8878) of exactly the bytes
// that the region's size asks for. The frame is walked before it is decoded, so that no hostile
// header can make the decoder allocate or loop beyond the region.

import { decompress } from 'fzstd';
import { failure, success, type Result } from './result';

const kMagic = 0xfd2fb528;
const kMaxBlockBytes = 128 * 1024;

/** The declared content size and the offset of the first block, or what is wrong. */
function frameHeader(data: Uint8Array): Result<{ size: number; blocks: number; checksum: boolean }> {
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  if (data.length < 9 || view.getUint32(0, true) !== kMagic) return failure('not a zstd frame');
  const descriptor = data[4]!;
  const singleSegment = (descriptor & 0x20) !== 0;
  if (descriptor & 0x0b) return failure('a zstd frame with a dictionary or reserved bits');
  const sizeFlag = descriptor >> 6;
  if (sizeFlag === 0 && !singleSegment) return failure('a zstd frame without its content size');
  const at = 5 + (singleSegment ? 0 : 1);
  const sizeBytes = sizeFlag === 0 ? 1 : 1 << sizeFlag;
  if (at + sizeBytes + 3 > data.length) return failure('a zstd frame that is cut short');
  const size = sizeBytes === 1 ? data[at]!
    : sizeBytes === 2 ? view.getUint16(at, true) + 256
      : sizeBytes === 4 ? view.getUint32(at, true)
        : Number(view.getBigUint64(at, true));
  return success({ size, blocks: at + sizeBytes, checksum: (descriptor & 4) !== 0 });
}

/** Where the frame's last block ends; fails where a block is illegal or reaches past the data. */
function endOfBlocks(data: Uint8Array, start: number, size: number): Result<number> {
  let at = start;
  let blocks = 0;
  for (;;) {
    if (at + 3 > data.length) return failure('a zstd frame that is cut short');
    const header = data[at]! | (data[at + 1]! << 8) | (data[at + 2]! << 16);
    const [last, type, blockSize] = [header & 1, (header >> 1) & 3, header >> 3];
    if (type === 3 || blockSize > kMaxBlockBytes) return failure('an illegal zstd block');
    at += 3 + (type === 1 ? 1 : blockSize);
    if (at > data.length) return failure('a zstd frame that is cut short');
    if (last) return success(at);
    if (++blocks > size) return failure('a zstd frame with more blocks than bytes');
  }
}

/** The `size` bytes in `data`. */
export function decodeZstd(data: Uint8Array, size: number): Result<Uint8Array> {
  const header = frameHeader(data);
  if (!header.ok) return header;
  if (header.value.size !== size) return failure(`a zstd frame of ${header.value.size} bytes where ${size} are due`);
  const end = endOfBlocks(data, header.value.blocks, size);
  if (!end.ok) return end;
  if (end.value + (header.value.checksum ? 4 : 0) !== data.length) return failure('bytes after a zstd frame');
  try {
    return success(decompress(data, new Uint8Array(size)));
  } catch (error) {
    return failure(`a zstd frame that does not decode (${error instanceof Error ? error.message : 'unknown'})`);
  }
}

/** Tightly packed RGB to RGBA with alpha 255. */
export function rgbaOfRgb(rgb: Uint8Array): Uint8ClampedArray<ArrayBuffer> {
  const pixels = rgb.length / 3;
  const words = new Uint32Array(pixels);
  // Canvas pixels are R, G, B, A in memory; every machine a browser runs on is little-endian.
  for (let i = 0, at = 0; i < pixels; ++i, at += 3) {
    words[i] = (0xff000000 | (rgb[at + 2]! << 16) | (rgb[at + 1]! << 8) | rgb[at]!) >>> 0;
  }
  return new Uint8ClampedArray(words.buffer);
}
