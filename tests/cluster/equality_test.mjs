// SPDX-License-Identifier: Apache-2.0
// The law of the cluster: the picture of N ranks is that of one worker with one thread, to the bit.
// Arguments: "loopback", or "mpi" and the number of ranks.

import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import test from 'node:test';
import { headScene, headVolume, inScratch, run, runCommand, runRanks } from './support/program.mjs';
import { camera, lit, sceneOf, surfaces, writeJson, writeNrrd } from './support/data.mjs';
import { covered, difference, readPng } from './support/picture.mjs';

const [transport, ranksText] = process.argv.slice(2);
const ranks = Number(ranksText ?? 0);
const volume = writeNrrd('bumps.nrrd');
const missingHead = existsSync(headVolume) ? false : 'the head of Debian\'s mricron-data is not installed';

const scenes = {
  'unlit dvr': writeJson('unlit.json', sceneOf(volume)),
  'lit dvr': writeJson('lit.json', sceneOf(volume, { shading: lit })),
  'isosurfaces': writeJson('surfaces.json', sceneOf(volume, { mode: 'isosurface', shading: lit, isosurfaces: surfaces })),
  'surfaces in dvr': writeJson('both.json', sceneOf(volume, { shading: lit, isosurfaces: surfaces })),
  'mip': writeJson('mip.json', sceneOf(volume, { mode: 'mip' })),
};

// Which samples a picture holds depends on its tiles where they are chosen: then only pictures of the same
// tiles can be equal.
const everyPixel = ['--sampling', 'every-pixel'];

/**
 * The pictures of a scene as floats and as bytes, made once by one worker with one thread; `options` are
 * those that a picture depends on.
 */
const references = new Map();
async function reference(scene, size, options = []) {
  const key = [scene, size, ...options].join(' ');
  if (!references.has(key)) {
    const name = inScratch(`reference-${references.size}`);
    references.set(key, name);
    for (const extension of ['exr', 'png']) {
      const made = await run(['render', scene, '-o', `${name}.${extension}`, '--size', size, '--threads', '1', ...options]);
      assert.equal(made.status, 0, made.stderr);
    }
    // Two black pictures would be equal too.
    assert.ok(covered(readPng(`${name}.png`)) > 0.05, 'the reference is empty');
  }
  return references.get(key);
}

async function differs(a, b) {
  const compared = await runCommand('idiff', ['-fail', '0', '-warn', '0', a, b]);
  return compared.status !== 0 && compared.stdout;
}

let count = 0;
async function expectEqual(scene, size, options, { mpiRanks = 0, quality = [] } = {}) {
  const extension = count % 2 === 0 ? 'exr' : 'png';
  const output = inScratch(`picture-${++count}.${extension}`);
  const args = ['render', scene, '-o', output, '--size', size, ...options, ...quality];
  const expected = `${await reference(scene, size, quality)}.${extension}`;
  const made = await (mpiRanks ? runRanks(mpiRanks, args) : run(args));
  assert.equal(made.status, 0, made.stderr);
  if (extension === 'png') assert.ok(readPng(output).rgb.equals(readPng(expected).rgb), made.line);
  else assert.equal(await differs(output, expected), false, made.line);
}

/** Workers and compositors that, with the master, are this many ranks. */
const roles = (total, compositors) =>
  ['--workers', String(total - 1 - compositors), '--compositors', String(compositors)];

test('A difference of the last bit of one float is found', async () => {
  const name = await reference(scenes.mip, '301x197');
  const changed = inScratch('changed.exr');
  const made = await runCommand('oiiotool', [`${name}.exr`, '--mulc', '1.0000001', '-o', changed]);
  assert.equal(made.status, 0, made.stderr);
  assert.notEqual(await differs(`${name}.exr`, changed), false);
});

if (transport === 'loopback') {
  for (const [mode, scene] of Object.entries(scenes)) {
    test(`${mode}: 3, 5 and 8 ranks in threads give the picture of one worker`, async () => {
      await expectEqual(scene, '301x197', roles(3, 1));
      await expectEqual(scene, '301x197', [...roles(5, 1), '--threads', '1']);
      await expectEqual(scene, '301x197', [...roles(5, 2), '--threads', '2']);
      await expectEqual(scene, '301x197', [...roles(8, 3), '--threads', '1']);
    });
  }
  const tilings = [['--tile', '16'], ['--tile', '32'], ['--tile', '128'], ['--schedule', 'rows']];
  test('Tiles of any size and rows give one picture of every pixel', async () => {
    for (const tiles of tilings) {
      await expectEqual(scenes['surfaces in dvr'], '301x197', [...tiles, ...roles(5, 2)], { quality: everyPixel });
      await expectEqual(scenes['lit dvr'], '301x197', [...tiles, ...roles(3, 1)], { quality: everyPixel });
    }
  });
  test('Frames whose dear tiles were split are to the bit those of tiles of one size', async () => {
    // Far away and with short steps all the cost is in a few tiles; each frame but the first knows the last one's.
    const far = writeJson('far.json', sceneOf(volume, { shading: lit },
                                              { camera: { ...camera, position: [150, -270, 120] } }));
    const frames = ['render', far, '--size', '301x197', '--orbit', '3,6', '--step', '0.02', ...everyPixel];
    const whole = await run([...frames, '-o', inScratch('whole%d.exr'), '--tile', '64', '--threads', '1']);
    assert.equal(whole.status, 0, whole.stderr);
    for (const [name, options] of [['few', ['--threads', '1']], ['some', [...roles(6, 2), '--threads', '1']],
                                   ['many', [...roles(8, 3), '--threads', '3']]]) {
      const report = inScratch(`${name}.json`);
      const made = await run([...frames, '-o', inScratch(`${name}%d.exr`), ...options, '--report', report]);
      assert.equal(made.status, 0, made.stderr);
      const tiles = JSON.parse(readFileSync(report)).tiles;
      const edges = new Set(tiles.map((tile) => tile.width).filter((width) => width % 16 === 0));
      if (name === 'some') assert.ok(edges.size > 1, `nothing was split: ${[...edges]}`);
      for (const frame of [0, 1, 2])
        assert.equal(await differs(inScratch(`whole${frame}.exr`), inScratch(`${name}${frame}.exr`)), false, made.line);
    }
  });
  test('Chosen samples of tiles of one size, or rows, give one picture over ranks', async () => {
    for (const tiles of tilings)
      await expectEqual(scenes['surfaces in dvr'], '301x197', roles(5, 2), { quality: tiles });
  });
  const qualities = {
    'a large error': ['--error', '4'],
    'a small error': ['--error', '0.1'],
    'two samples at most': ['--error', '0.01', '--samples', '2'],
    'conventional subdivision': ['--sampling', 'subdivision'],
    'four samples in each pixel': [...everyPixel, '--samples', '4'],
    'constant blocks': ['--error', '4', '--filter', 'box'],
    'bicubic filling': ['--error', '4', '--filter', 'bicubic'],
    'smoothed pixels': ['--error', '4', '--filter', 'biquadratic'],
  };
  for (const [name, quality] of Object.entries(qualities)) {
    test(`Ranks agree on a picture of ${name}`, async () => {
      await expectEqual(scenes['surfaces in dvr'], '301x197', roles(3, 1), { quality });
      await expectEqual(scenes['surfaces in dvr'], '301x197', [...roles(8, 3), '--threads', '1'], { quality });
      await expectEqual(scenes['lit dvr'], '301x197', [...roles(6, 1), '--threads', '2'], { quality });
    });
  }
  test('Each way to refine makes a picture of its own, near that of many samples', async () => {
    const many = readPng(`${await reference(scenes['lit dvr'], '301x197', [...everyPixel, '--samples', '64'])}.png`);
    const pictures = [['--error', '4'], [], ['--sampling', 'subdivision'], everyPixel, [...everyPixel, '--samples', '4']];
    const seen = [];
    for (const quality of pictures) {
      const picture = readPng(`${await reference(scenes['lit dvr'], '301x197', quality)}.png`);
      for (const other of seen) assert.ok(!picture.rgb.equals(other.rgb), `${quality}`);
      assert.ok(difference(picture, many).mean < 1, `${quality}`);
      seen.push(picture);
    }
  });
  test('One, two and three threads give one picture', async () => {
    for (const threads of ['1', '2', '3']) {
      await expectEqual(scenes['lit dvr'], '301x197', ['--threads', threads]);
      await expectEqual(scenes.mip, '301x197', ['--threads', threads, '--workers', '2']);
    }
  });
  test('Pictures of a few pixels are right with more ranks than tiles', async () => {
    for (const size of ['1x1', '2x2', '3x65', '64x64', '65x2']) {
      for (const quality of [[], everyPixel]) {
        const expected = inScratch(`small-${size}.png`), output = inScratch(`many-${size}.png`);
        for (const [file, options] of [[expected, []], [output, roles(8, 3)]]) {
          const made = await run(['render', scenes['lit dvr'], '-o', file, '--size', size, ...options, ...quality]);
          assert.equal(made.status, 0, made.stderr);
        }
        assert.deepEqual(readPng(output), readPng(expected), size);
      }
    }
  });
} else {
  const compositors = { 3: [1], 5: [1, 2, 3], 8: [2, 3] }[ranks];
  const modes = Object.entries(scenes);
  compositors.forEach((number, i) => {
    for (const [mode, scene] of [modes[(ranks + i) % 5], modes[(ranks + i + 2) % 5]]) {
      test(`${mode}: mpirun -n ${ranks} with ${number} compositors gives the picture of one worker`, async () => {
        await expectEqual(scene, '301x197', ['--compositors', String(number), '--threads', '1'],
                          { mpiRanks: ranks, quality: i === 1 ? ['--tile', '32'] : [] });
      });
    }
  });
  test(`Rows under mpirun -n ${ranks} give the picture of one worker`, async () => {
    await expectEqual(scenes['lit dvr'], '157x211', ['--threads', '2'], { mpiRanks: ranks, quality: ['--schedule', 'rows'] });
  });
  test(`The head under mpirun -n ${ranks} is the head of one worker`, { skip: missingHead }, async () => {
    await expectEqual(headScene, '201x153', [], { mpiRanks: ranks });
  });
  test(`Subdivision and samples of every pixel under mpirun -n ${ranks} are those of one worker`, async () => {
    for (const quality of [['--sampling', 'subdivision'], [...everyPixel, '--samples', '4']])
      await expectEqual(scenes['surfaces in dvr'], '157x211', ['--threads', '1'], { mpiRanks: ranks, quality });
  });
}
