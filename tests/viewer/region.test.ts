// SPDX-License-Identifier: Apache-2.0
import { PictureAssembler } from '../../viewer/src/picture-assembler';
import { decodeRegion, type Region } from '../../viewer/src/region';

/** A region as docs/viewer-protocol.md lays it out, with `change` applied to its header. */
function bytes(change: (view: DataView) => void = () => {}, payload = 5): ArrayBuffer {
  const buffer = new ArrayBuffer(44 + payload);
  const view = new DataView(buffer);
  [0x47525447, 7, 3, 2, 91].forEach((value, i) => view.setUint32(4 * i, value, true));
  [10, 20, 30, 40, 64, 96].forEach((value, i) => view.setUint16(20 + 2 * i, value, true));
  [2, 1, 3, 0, 1, 5, 7].forEach((value, i) => view.setUint8(32 + i, value));
  view.setFloat32(40, 0.375, true);
  change(view);
  return buffer;
}

function region(picture: number, index: number, count: number, imageWidth = 8): Region {
  return {
    picture, index, count, imageWidth, imageHeight: 8, epoch: 1, viewer: 0, serial: 0, encoding: 'zstd',
    final: false, cineFrame: 0, cineFrames: 0, estimatedError: null, rect: { x: 0, y: 0, width: 1, height: 1 }, payload: new Uint8Array(1),
  };
}

test('Region.EveryFieldIsReadFromItsPlace', () => {
  const decoded = decodeRegion(bytes());
  expect(decoded.ok && { ...decoded.value, payload: decoded.value.payload.length }).toEqual({
    picture: 7, epoch: 3, viewer: 2, serial: 91, rect: { x: 10, y: 20, width: 30, height: 40 }, imageWidth: 64,
    imageHeight: 96, encoding: 'zstd', index: 1, count: 3, final: true, cineFrame: 5, cineFrames: 7,
    estimatedError: 0.375, payload: 5,
  });
});

test('Region.BrokenHeadersAreRefused', () => {
  const broken: [string, (view: DataView) => void][] = [
    ['magic', (view) => view.setUint32(0, 0x47525446, true)],
    ['beyond the right edge', (view) => view.setUint16(20, 35, true)],
    ['beyond the lower edge', (view) => view.setUint16(22, 57, true)],
    ['no width', (view) => view.setUint16(24, 0, true)],
    ['no height', (view) => view.setUint16(26, 0, true)],
    ['no image', (view) => view.setUint16(28, 0, true)],
    ['huge image', (view) => view.setUint16(28, 4097, true)],
    ['encoding', (view) => view.setUint8(32, 3)],
    ['index', (view) => view.setUint8(33, 3)],
    ['count', (view) => view.setUint8(34, 0)],
    ['final flag', (view) => view.setUint8(36, 2)],
    ['reserved', (view) => view.setUint8(39, 1)],
    ['a spacing', (view) => view.setUint8(35, 8)],
    ['cine frame 0 of 7', (view) => view.setUint8(37, 0)],
    ['cine frame 8 of 7', (view) => view.setUint8(37, 8)],
    ['cine frame 5 of none', (view) => view.setUint8(38, 0)],
    ['cine frame 5 of 6', (view) => view.setUint8(38, 6)],
    ['error', (view) => view.setFloat32(40, NaN, true)],
  ];
  expect(broken.filter(([, change]) => decodeRegion(bytes(change)).ok).map(([name]) => name)).toEqual([]);
  expect(decodeRegion(bytes(() => {}, 0)).ok).toBe(false);
  expect(decodeRegion(new ArrayBuffer(3)).ok).toBe(false);
});

test('Region.ANegativeErrorIsUnknown', () => {
  for (const [error, decoded] of [[-1, null], [-Infinity, null], [0, 0], [2.5, 2.5]] as const) {
    const result = decodeRegion(bytes((view) => view.setFloat32(40, error, true)));
    expect(result.ok && result.value.estimatedError).toBe(decoded);
  }
});

test('PictureAssembler.APictureComesOutOnceWhenAllRegionsHaveCome', () => {
  const assembler = new PictureAssembler();
  expect(assembler.push(region(1, 2, 3))).toEqual({ ok: true, value: null });
  expect(assembler.push(region(1, 0, 3))).toEqual({ ok: true, value: null });
  const complete = assembler.push(region(1, 1, 3));
  expect(complete.ok && complete.value?.map(({ index }) => index)).toEqual([0, 1, 2]);
  expect(assembler.push(region(1, 1, 3)).ok).toBe(false);
});

test('PictureAssembler.ANewerPictureReplacesAnIncompleteOne', () => {
  const assembler = new PictureAssembler();
  assembler.push(region(1, 0, 2));
  assembler.push(region(2, 0, 2));
  expect(assembler.push(region(1, 1, 2))).toEqual({ ok: true, value: null });
  const complete = assembler.push(region(2, 1, 2));
  expect(complete.ok && complete.value?.every(({ picture }) => picture === 2)).toBe(true);
});

test('PictureAssembler.ContradictionsAndRepetitionsAreRefused', () => {
  const assembler = new PictureAssembler();
  assembler.push(region(1, 0, 2));
  expect(assembler.push(region(1, 0, 2)).ok).toBe(false);
  expect(assembler.push(region(1, 1, 3)).ok).toBe(false);
  expect(assembler.push(region(1, 1, 2, 9)).ok).toBe(false);
});

test('PictureAssembler.ANewConnectionNumbersItsPicturesAnew', () => {
  const assembler = new PictureAssembler();
  assembler.push(region(500, 0, 1));
  assembler.reset();
  const complete = assembler.push(region(1, 0, 1));
  expect(complete.ok && complete.value?.length).toBe(1);
});
