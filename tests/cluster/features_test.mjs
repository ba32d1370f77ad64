// SPDX-License-Identifier: Apache-2.0
// What the options of the command line promise: orbits, reports, scenes inside pictures, time limits,
// and that what is meant for people and what is meant for pipes stay apart.

import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import test from 'node:test';
import { inScratch, run, start } from './support/program.mjs';
import { camera, lit, sceneOf, surfaces, writeJson, writeNrrd } from './support/data.mjs';
import { covered, difference, readPng } from './support/picture.mjs';

const kSize = 96;
const kPixels = kSize * kSize;
const kSame = { pixels: 0, greatest: 0, mean: 0 };
const volume = writeNrrd('bumps.nrrd');
const scene = writeJson('scene.json', sceneOf(volume, { shading: lit }));
const sum = (numbers) => numbers.reduce((a, b) => a + b, 0);

/** Runs `render` with options; its picture is read by whoever wants it. */
async function render(input, output, ...options) {
  const size = options.includes('--size') ? [] : ['--size', `${kSize}x${kSize}`];
  const made = await run(['render', input, '-o', inScratch(output), ...size, ...options]);
  assert.equal(made.status, 0, made.stderr);
  assert.equal(made.stdout, '');
  return made;
}
const picture = (name) => readPng(inScratch(name));

async function reported(name, ...options) {
  await render(scene, `${name}.png`, '--report', inScratch(`${name}.json`), ...options);
  return JSON.parse(readFileSync(inScratch(`${name}.json`), 'utf8'));
}

test('An orbit begins at the camera of the scene and turns', async () => {
  await render(scene, 'still.png');
  await render(scene, 'frame%02d.png', '--orbit', '4');
  const frames = [0, 1, 2, 3].map((i) => picture(`frame0${i}.png`));
  assert.ok(!existsSync(inScratch('frame04.png')));
  assert.ok(covered(frames[0]) > 0.05, 'nothing to see');
  assert.deepEqual(difference(frames[0], picture('still.png')), kSame);
  for (let i = 0; i < 4; ++i) {
    for (let k = 0; k < i; ++k) assert.ok(difference(frames[i], frames[k]).mean > 1, `frames ${k} and ${i}`);
  }
});

test('An orbit turns the camera counter-clockwise, seen from the tip of up', async () => {
  const [x, y, z] = camera.position;
  const turned = writeJson('turned.json', sceneOf(volume, { shading: lit }, { camera: { ...camera, position: [-y, x, z] } }));
  await render(turned, 'turned.png');
  await render(scene, 'quarter%d.png', '--orbit', '2,180');
  const delta = difference(picture('turned.png'), picture('quarter1.png'));
  // The angle's sine and cosine are rounded, and with them values at the edge of a step of 8 bits.
  assert.ok(delta.greatest <= 1 && delta.mean < 0.01, JSON.stringify(delta));
});

test('A report says what was done, and its numbers agree with each other', async () => {
  const report = await reported('report', '--workers', '2', '--compositors', '2', '--tile', '32');
  const [frame] = report.frames;
  assert.equal(report.frames.length, 1);
  assert.equal(frame.rays, kPixels);
  assert.ok(frame.samples >= frame.rays, `${frame.samples} samples`);
  assert.ok(frame.firstPictureSeconds > 0 && frame.firstPictureSeconds <= frame.seconds);
  assert.ok(frame.estimatedError >= 0 && frame.estimatedError < 255);
  assert.equal(frame.spacing, 1);
  assert.ok(report.loadSeconds > 0);
  assert.match(report.version, /^\d+\.\d+\.\d+/);
  assert.ok(report.kernel.length > 0 && Array.isArray(report.features));

  assert.deepEqual(report.ranks.map(({ rank }) => rank), [0, 1, 2, 3, 4]);
  assert.deepEqual(report.ranks.map(({ role }) => role), ['master', 'compositor', 'compositor', 'worker', 'worker']);
  for (const { host, busySeconds } of report.ranks) assert.ok(host.length > 0 && busySeconds >= 0);
});

test('The tiles of a report cover the picture once', async () => {
  const { tiles } = await reported('cover', '--size', '90x70', '--tile', '32');
  const times = new Uint8Array(90 * 70);
  for (const { x, y, width, height } of tiles) {
    for (let row = y; row < y + height; ++row) {
      for (let column = x; column < x + width; ++column) ++times[row * 90 + column];
    }
  }
  assert.ok(times.every((count) => count === 1));
  assert.equal(sum(tiles.map(({ width, height }) => width * height)), times.length);
});

test('The seconds of the tiles are those that the workers were busy', async () => {
  const { ranks, tiles } = await reported('busy', '--workers', '2', '--tile', '16', '--step', '0.02');
  const workers = ranks.filter(({ role }) => role === 'worker');
  assert.ok(tiles.every(({ worker }) => workers.some(({ rank }) => rank === worker)));
  const busy = sum(workers.map(({ busySeconds }) => busySeconds));
  const cast = sum(tiles.map(({ seconds }) => seconds));
  assert.ok(Math.abs(cast - busy) < 0.1 * busy, `${cast} s in tiles, ${busy} s in workers`);
});

test('The bytes of a report hold every sample and every pixel', async () => {
  const { bytes } = await reported('bytes');
  assert.ok(bytes.Samples >= 16 * kPixels && bytes.Samples < 32 * kPixels, `${bytes.Samples}`);
  assert.ok(bytes.BandPicture >= 16 * kPixels, `${bytes.BandPicture}`);
  for (const count of Object.values(bytes)) assert.ok(Number.isInteger(count) && count >= 0);
});

test('A picture holds the scene that makes it again, to the bit', async () => {
  const kinds = { dvr: { shading: lit }, mip: { mode: 'mip' }, surfaces: { mode: 'isosurface', shading: lit, isosurfaces: surfaces } };
  for (const [name, keys] of Object.entries(kinds)) {
    await render(writeJson(`${name}.json`, sceneOf(volume, keys)), `${name}.png`);
    const first = picture(`${name}.png`);
    assert.ok(covered(first) > 0.05, `${name}: nothing to see`);
    const made = await run(['render', writeJson(`${name}-again.json`, first.texts['goldthread:scene']), '-o', inScratch(`${name}-again.png`)]);
    assert.equal(made.status, 0, made.stderr);
    assert.deepEqual(difference(picture(`${name}-again.png`), first), kSame, name);
  }
});

// A rigid motion of volume and camera changes nothing that is seen. Positions of some 100 mm are rounded
// to floats, by 2⁻¹⁷ mm: far less than a step of 8 bits, but a value at a step's edge may fall on the
// other side of it. Measured: not one pixel.
for (const { name, turn, move } of [
  { name: 'a quarter turn', turn: ([x, y, z]) => [-y, x, z], move: [64, -32, 16] },
  { name: 'an odd turn', turn: ([x, y, z]) => [0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y, z], move: [10.3, -7.7, 3.1] },
]) {
  test(`A volume whose header has ${name} looks the same to a camera that moves along`, async () => {
    const moved = (v) => turn(v).map((c, i) => c + move[i]);
    const origin = [-11.5, -9.5, -7.5];
    const axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    const other = writeNrrd('moved.nrrd', { origin: moved(origin), directions: axes.map(turn) });
    const along = { camera: { ...camera, position: moved(camera.position), target: moved(camera.target), up: turn(camera.up) } };
    for (const keys of [{ shading: lit }, { mode: 'mip' }]) {
      await render(writeJson('here.json', sceneOf(volume, keys)), 'here.png');
      await render(writeJson('there.json', sceneOf(other, keys, along)), 'there.png');
      await render(writeJson('left.json', sceneOf(other, keys)), 'left.png');
      const delta = difference(picture('here.png'), picture('there.png'));
      assert.ok(delta.greatest <= 1 && delta.mean < 0.01, JSON.stringify(delta));
      assert.ok(difference(picture('here.png'), picture('left.png')).mean > 1, 'the header moves nothing');
    }
  });
}

test('A render whose time is up writes the picture that it has', async () => {
  const { frames: [frame] } = await reported('hasty', '--size', '1024x1024', '--step', '0.05', '--time', '0.001');
  assert.ok(frame.spacing > 1, `spacing ${frame.spacing}`);
  assert.ok(frame.rays < 1024 * 1024);
  const hasty = picture('hasty.png');
  assert.equal(hasty.width, 1024);
  assert.ok(covered(hasty) > 0.05);
});

test('info tells size and range on stdout, and nothing else anywhere', async () => {
  for (const input of [volume, scene]) {
    const told = await run(['info', input]);
    assert.equal(told.status, 0, told.stderr);
    assert.equal(told.stderr, '');
    assert.match(told.stdout, /^size +24 . 20 . 16/m);
    assert.match(told.stdout, /^range +0 \S+ 255/m);
  }
});

test('Progress is told on stderr only', async () => {
  const args = ['render', scene, '-o', inScratch('never.png'), '--size', '8192x8192', '--step', '0.001'];
  const long = start(args);
  await long.until(() => /rendering: \d+ %/.test(long.stderr));
  long.signal('SIGINT');
  assert.equal((await long.ended).stdout, '');
});
