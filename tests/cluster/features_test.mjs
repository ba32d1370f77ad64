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
  assert.equal(frame.samplesPerPixel, frame.rays / kPixels);
  assert.ok(frame.samples >= frame.rays, `${frame.samples} samples`);
  assert.ok(frame.firstPictureSeconds > 0 && frame.firstPictureSeconds <= frame.seconds);
  assert.ok(frame.takenSeconds > 0 && frame.takenSeconds <= frame.seconds);
  assert.ok(report.loadSeconds > 0);
  assert.match(report.version, /^\d+\.\d+\.\d+/);
  assert.ok(report.kernel.length > 0 && Array.isArray(report.features));

  assert.deepEqual(report.ranks.map(({ rank }) => rank), [0, 1, 2, 3, 4]);
  // Within a machine nothing is compressed.
  assert.equal(report.links.length, 2 + 2 * 2);
  for (const { compressed, rawBytes, sentBytes } of report.links) assert.deepEqual([compressed, rawBytes], [0, sentBytes]);
  assert.deepEqual(report.ranks.map(({ role }) => role), ['master', 'compositor', 'compositor', 'worker', 'worker']);
  for (const { host, busySeconds } of report.ranks) assert.ok(host.length > 0 && busySeconds >= 0);
});

test('The steps of a report lead to the picture', async () => {
  const { frames: [frame] } = await reported('steps');
  const { steps } = frame;
  assert.ok(steps.length >= 3);
  for (let i = 1; i < steps.length; ++i) {
    assert.ok(steps[i].rays >= steps[i - 1].rays);
    assert.ok(steps[i].seconds >= steps[i - 1].seconds);
  }
  // Grids of 16 and 8 pixels in tiles of 64 and what is left of 96, with the replicated ones.
  assert.equal(steps[0].rays, (5 + 3) ** 2);
  assert.equal(steps[1].rays, (9 + 5) ** 2);
  const last = steps.at(-1);
  assert.deepEqual([frame.rays, frame.estimatedError, frame.seconds], [last.rays, last.estimatedError, last.seconds]);
  assert.equal(frame.firstPictureSeconds, steps[0].seconds);
});

test('A picture is refined until the error that was asked for, 0.5 unless told otherwise', async () => {
  const errorOf = async (...options) => (await reported('asked', ...options)).frames[0];
  for (const [wanted, options] of [[0.5, []], [4, ['--error', '4']], [0.1, ['--error', '0.1']]]) {
    const { estimatedError, steps } = await errorOf(...options);
    assert.ok(estimatedError <= wanted, `${estimatedError} of ${wanted}`);
    // Not a step further, but those that are too coarse to tell.
    for (const { estimatedError: before } of steps.slice(2, -1)) assert.ok(before > wanted, `${before} of ${wanted}`);
  }
  assert.ok((await errorOf('--error', '4')).rays < (await errorOf('--error', '0.1')).rays);
});

test('The error that was asked for is about what the picture is off by', async () => {
  await render(scene, 'many.png', '--sampling', 'every-pixel', '--samples', '256');
  let before = Infinity;
  for (const error of ['8', '2', '0.5']) {
    await render(scene, 'some.png', '--error', error);
    const { mean } = difference(picture('some.png'), picture('many.png'));
    // The mean is below the root mean square; eight bits round by a quarter on average.
    assert.ok(mean <= 1.5 * Number(error) + 0.25, `${mean} of ${error}`);
    assert.ok(mean < before, `${mean} after ${before}`);
    before = mean;
  }
});

test('--samples bounds the samples of a pixel', async () => {
  const even = async (...options) => (await reported('even', '--sampling', 'every-pixel', '--tile', '64', ...options)).frames[0];
  const one = await even(), four = await even('--samples', '4');
  // Beside one ray in each pixel's centre those around the tiles, which must be as large as chosen samples' are.
  const around = one.rays - kPixels;
  assert.ok(around >= 0 && around < kPixels / 8, `${around}`);
  assert.equal(four.rays, 4 * kPixels + around);
  const chosen = async (samples) => (await reported('chosen', '--error', '0.1', '--samples', samples)).frames[0];
  const [two, many] = [await chosen('2'), await chosen('1024')];
  assert.ok(two.rays <= 2 * kPixels + around, `${two.rays}`);
  assert.ok(many.rays > two.rays && many.estimatedError < two.estimatedError);
});

test('Every pixel of the smallest pictures has its rays', async () => {
  // Around so few pixels there are more rays than in them.
  for (const [samples, last] of [['1', 3], ['4', 4], ['9', 5]]) {
    for (const size of ['1x1', '2x2', '17x1']) {
      const { frames: [{ steps }] } = await reported('few', '--sampling', 'every-pixel', '--samples', samples, '--size', size);
      assert.equal(steps.length, last, `${size} with ${samples}`);
    }
  }
});

test('Every filter and kind of sampling makes a picture', async () => {
  await render(scene, 'exact.png', '--sampling', 'every-pixel', '--samples', '64');
  const exact = picture('exact.png');
  const seen = new Map();
  for (const filter of ['box', 'bilinear', 'biquadratic', 'piecewise-quadratic', 'bicubic']) {
    // Coarse enough that there is something to fill in.
    await render(scene, 'filter.png', '--filter', filter, '--error', '8');
    const made = picture('filter.png');
    assert.ok(difference(made, exact).mean < 10, filter);
    seen.set(filter, made);
  }
  // Halfway between two samples the piecewise quadratic filter says what the bilinear one does.
  assert.deepEqual(difference(seen.get('piecewise-quadratic'), seen.get('bilinear')), kSame);
  for (const filter of ['box', 'biquadratic', 'bicubic'])
    assert.ok(difference(seen.get(filter), seen.get('bilinear')).pixels > 0, filter);
  for (const sampling of ['adaptive', 'subdivision', 'every-pixel']) {
    await render(scene, 'sampling.png', '--sampling', sampling);
    assert.ok(difference(picture('sampling.png'), exact).mean < 1, sampling);
  }
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
  const { bytes } = await reported('bytes', '--sampling', 'every-pixel');
  // Colour and place of each.
  assert.ok(bytes.Samples >= 20 * kPixels && bytes.Samples < 32 * kPixels, `${bytes.Samples}`);
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
  for (const sampling of ['adaptive', 'every-pixel']) {
    const { frames: [frame] } = await reported('hasty', '--size', '1024x1024', '--step', '0.05', '--time', '0.001',
                                               '--error', '0.01', '--sampling', sampling);
    assert.ok(frame.steps.length >= 1, 'at least the first step');
    assert.ok(frame.estimatedError > 0.01);
    assert.ok(frame.rays < 1024 * 1024);
    const hasty = picture('hasty.png');
    assert.equal(hasty.width, 1024);
    assert.ok(covered(hasty) > 0.05);
  }
});

test('A render without end but for its time ends in time', async () => {
  const seconds = 1;
  const { frames: [frame] } = await reported('timely', '--size', '512x512', '--step', '0.01', '--error', '0.01',
                                             '--time', String(seconds));
  assert.ok(frame.estimatedError > 0.01, 'there was something left to do');
  assert.ok(frame.steps.length >= 2);
  for (const step of frame.steps) assert.ok(step.seconds < seconds + 1, `${step.seconds}`);
  assert.ok(covered(picture('timely.png')) > 0.05);
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
  const args = ['render', scene, '-o', inScratch('never.png'), '--size', '2048x2048', '--step', '0.001', '--error', '0.01'];
  const long = start(args);
  await long.until(() => /rendering: \d+ %/.test(long.stderr));
  long.signal('SIGINT');
  assert.equal((await long.ended).stdout, '');
});
