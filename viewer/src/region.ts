// SPDX-License-Identifier: Apache-2.0
// The header of a region of a picture. Every field is checked before a byte of the payload is
// looked at: a region lies inside its image and its index inside the count.

import { failure, success, type Result } from './result';

const kMagic = 0x47525447;
const kHeaderBytes = 44;
const kMaxEdge = 4096;
const kLoopFrames = 7;

export interface RegionRect {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

export interface Region {
  readonly picture: number;
  readonly epoch: number;
  readonly viewer: number;
  readonly serial: number;
  readonly rect: RegionRect;
  readonly imageWidth: number;
  readonly imageHeight: number;
  readonly encoding: 'jpeg' | 'zstd';
  readonly index: number;
  readonly count: number;
  readonly final: boolean;
  /** 1 … cineFrames; 0: no frame of the cine loop. */
  readonly cineFrame: number;
  readonly cineFrames: number;
  /** Root mean square in 1/255; null: unknown. */
  readonly estimatedError: number | null;
  readonly payload: Uint8Array<ArrayBuffer>;
}

const cinePlace = (frame: number, frames: number): boolean =>
  frames === 0 ? frame === 0 : frames === kLoopFrames && frame >= 1 && frame <= frames;

export function decodeRegion(message: ArrayBuffer): Result<Region> {
  if (message.byteLength <= kHeaderBytes) return failure(`a region of ${message.byteLength} bytes is too short`);
  const view = new DataView(message);
  const u16 = (offset: number): number => view.getUint16(offset, true);
  const u32 = (offset: number): number => view.getUint32(offset, true);
  if (u32(0) !== kMagic) return failure('a binary message that is not a region');
  const rect = { x: u16(20), y: u16(22), width: u16(24), height: u16(26) };
  const [imageWidth, imageHeight] = [u16(28), u16(30)];
  const [encoding, index, count, final, cineFrame, cineFrames] = [32, 33, 34, 36, 37, 38].map((at) => view.getUint8(at));
  const error = view.getFloat32(40, true);
  if (imageWidth < 1 || imageHeight < 1 || imageWidth > kMaxEdge || imageHeight > kMaxEdge) {
    return failure(`an image of ${imageWidth} × ${imageHeight} pixels`);
  }
  if (rect.width < 1 || rect.height < 1 || rect.x + rect.width > imageWidth || rect.y + rect.height > imageHeight) {
    return failure('a region that does not lie in its image');
  }
  if (encoding !== 1 && encoding !== 2) return failure(`a region of unknown encoding ${encoding}`);
  if (index! >= count!) return failure(`region ${index} of ${count}`);
  if (final! > 1) return failure(`a region whose final flag is ${final}`);
  if (!cinePlace(cineFrame!, cineFrames!)) return failure(`cine frame ${cineFrame} of ${cineFrames}`);
  if (view.getUint8(35) || view.getUint8(39)) return failure('a region with reserved bytes set');
  if (Number.isNaN(error)) return failure('an estimated error that is not a number');
  return success({
    picture: u32(4), epoch: u32(8), viewer: u32(12), serial: u32(16), rect, imageWidth, imageHeight,
    encoding: encoding === 1 ? 'jpeg' : 'zstd', index: index!, count: count!, final: final === 1,
    cineFrame: cineFrame!, cineFrames: cineFrames!, estimatedError: error >= 0 ? error : null,
    payload: new Uint8Array(message, kHeaderBytes),
  });
}
