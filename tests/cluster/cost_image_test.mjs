// SPDX-License-Identifier: Apache-2.0
// `render --cost-image`: the picture of where the time went, held against the tiles of the report.

import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import test from 'node:test';
import { errorLines, inScratch, run } from './support/program.mjs';
import { lit, sceneOf, writeJson, writeNrrd } from './support/data.mjs';
import { readPng } from './support/picture.mjs';

const scene = writeJson('scene.json', sceneOf(writeNrrd('bumps.nrrd'), { shading: lit }));
// The right and lower tiles are cut.
const kSize = ['--size', '80x72', '--tile', '32', '--workers', '2', '--threads', '1'];
const kDarkest = [0x44, 0x01, 0x54], kBrightest = [0xfd, 0xe7, 0x25];

const render = (...options) => run(['render', scene, ...kSize, ...options]);
const at = ({ width, rgb }, x, y) => [...rgb.subarray(3 * (width * y + x), 3 * (width * y + x) + 3)];
const luminance = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;
const density = ({ seconds, width, height }) => seconds / (width * height);

test('Its colours are the tiles of the report, by time per pixel', async () => {
  const made = await render('-o', inScratch('a.png'), '--cost-image', inScratch('cost.png'), '--report', inScratch('a.json'));
  assert.equal(made.status, 0, made.stderr);
  const cost = readPng(inScratch('cost.png'));
  const { tiles } = JSON.parse(readFileSync(inScratch('a.json'), 'utf8'));
  assert.equal(`${cost.width}x${cost.height}`, '80x72');
  assert.equal(tiles.length, 9);
  // One colour for all of a tile but its edges.
  const colors = tiles.map((tile) => {
    const inside = at(cost, tile.x + tile.width - 1, tile.y + tile.height - 1);
    for (let y = 1; y < tile.height; ++y) {
      for (let x = 1; x < tile.width; ++x) assert.deepEqual(at(cost, tile.x + x, tile.y + y), inside);
    }
    if (tile.x > 0) assert.ok(luminance(at(cost, tile.x, tile.y + 5)) < luminance(inside), 'an edge');
    return inside;
  });
  const order = tiles.map((_, i) => i).sort((a, b) => density(tiles[a]) - density(tiles[b]));
  assert.deepEqual(colors[order.at(-1)], kBrightest);
  for (let i = 1; i < order.length; ++i) assert.ok(luminance(colors[order[i]]) >= luminance(colors[order[i - 1]]));
  assert.ok(luminance(colors[order[0]]) < luminance(kBrightest) - 20, 'tiles cost the same');
  assert.ok(luminance(colors[order[0]]) >= luminance(kDarkest));
  // What the brightest stands for is told in the file and on stderr.
  const scale = cost.texts['goldthread:costScale'];
  const told = Number(/^0 to (\S+) ms per 32x32 pixels$/.exec(scale)?.[1]);
  const expected = 1e3 * 32 * 32 * density(tiles[order.at(-1)]);
  assert.ok(Math.abs(told / expected - 1) < 0.01, `${scale}, of the tiles ${expected}`);
  assert.ok(made.stderr.includes(scale), made.stderr);
});

test('An orbit writes one for each frame, and floats where the format has them', async () => {
  const made = await render('-o', inScratch('f%d.png'), '--orbit', '2', '--cost-image', inScratch('c%d.exr'));
  assert.equal(made.status, 0, made.stderr);
  for (const name of ['c0.exr', 'c1.exr']) assert.ok(existsSync(inScratch(name)), name);
  assert.ok(!existsSync(inScratch('c2.exr')));
});

test('What cannot be written is found before the picture is made', async () => {
  const fails = async (status, pattern, ...options) => {
    const result = await render('-o', inScratch('none.png'), ...options);
    assert.equal(result.status, status, result.stderr);
    assert.equal(errorLines(result).length, 1, result.stderr);
    assert.match(errorLines(result)[0], pattern);
    assert.ok(!existsSync(inScratch('none.png')));
  };
  await fails(4, /no\/c\.png: cannot be written/, '--cost-image', inScratch('no/c.png'));
  await fails(2, /no image format is known/, '--cost-image', inScratch('c.txt'));
  await fails(2, /--cost-image: names the place of the picture itself/, '--cost-image', inScratch('none.png'));
});
