// SPDX-License-Identifier: Apache-2.0
// Regions as the gateway would send them: JPEG while moving, zstd frames of raw blocks at rest.

import jpeg from 'jpeg-js';

export interface PictureFields {
  picture: number; epoch: number; viewer: number; serial: number; width: number; height: number;
  lossless: boolean; final: boolean; cineFrame: number; cineFrames: number; error: number;
}

/** A legal zstd frame that compresses nothing. */
export function rawZstd(data: Uint8Array): Uint8Array {
  const header = Buffer.alloc(9);
  header.writeUInt32LE(0xfd2fb528, 0);
  header[4] = 0xa0;
  header.writeUInt32LE(data.length, 5);
  const parts: Uint8Array[] = [header];
  for (let at = 0; at === 0 || at < data.length; at += 131072) {
    const block = data.subarray(at, at + 131072);
    const last = at + 131072 >= data.length ? 1 : 0;
    const blockHeader = Buffer.alloc(3);
    blockHeader.writeUIntLE((block.length << 3) | last, 0, 3);
    parts.push(blockHeader, block);
  }
  return Buffer.concat(parts);
}

function jpegOf(rgb: Uint8Array, width: number, height: number): Uint8Array {
  const data = Buffer.alloc(width * height * 4, 255);
  for (let i = 0; i < width * height; ++i) data.set(rgb.subarray(3 * i, 3 * i + 3), 4 * i);
  return jpeg.encode({ data, width, height }, 85).data;
}

/** The picture in two bands, as two compositors would send it. */
export function regionsOf(rgb: Uint8Array, fields: PictureFields): Buffer[] {
  const { width, height } = fields;
  const split = height >> 1;
  return [[0, split], [split, height - split]].map(([y, rows], index) => {
    const band = rgb.subarray(y! * width * 3, (y! + rows!) * width * 3);
    const header = Buffer.alloc(44);
    [0x47525447, fields.picture, fields.epoch, fields.viewer, fields.serial]
      .forEach((value, i) => header.writeUInt32LE(value, 4 * i));
    [0, y!, width, rows!, width, height].forEach((value, i) => header.writeUInt16LE(value, 20 + 2 * i));
    const { lossless } = fields;
    header.set([lossless ? 2 : 1, index, 2, 0, fields.final ? 1 : 0, fields.cineFrame, fields.cineFrames], 32);
    header.writeFloatLE(fields.error, 40);
    return Buffer.concat([header, lossless ? rawZstd(band) : jpegOf(band, width, rows!)]);
  });
}
