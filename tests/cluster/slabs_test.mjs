// SPDX-License-Identifier: Apache-2.0
// A volume in slabs, none of which is the whole, gives the picture of the whole one, to the bit.
// Arguments: "loopback", "mpi", or "large": 4 GiB of voxels.

import assert from 'node:assert/strict';
import { existsSync, readFileSync, rmSync, statfsSync } from 'node:fs';
import { freemem } from 'node:os';
import path from 'node:path';
import test from 'node:test';
import { errorLines, headScene, headVolume, inScratch, leftOver, processOfRank, program, run, runCommand, runRanks,
         scratch, startRecoverable } from './support/program.mjs';
import { lit, sceneOf, surfaces, writeJson, writeNrrd } from './support/data.mjs';
import { covered, readPng } from './support/picture.mjs';

const how = process.argv[2];
// Oblique, so that borders of slabs lie across the picture in no simple way; 5 layers of cells.
const volume = writeNrrd('bumps.nrrd', {
  size: [24, 20, 37], origin: [-12, -9, -16], directions: [[1, 0.1, 0], [-0.1, 1, 0.2], [0, -0.2, 0.9]],
  value: (x, y, z) => {
    const distance = Math.hypot(x - 11, y - 9.5, (z - 18) / 2);
    return Math.round(Math.max(0, Math.min(255, 255 - 22 * distance + 40 * Math.sin(1.3 * x) * Math.cos(y + z))));
  },
});
const view = (position, up = [0, 0, 1]) => ({ camera: { position, target: [0, 0, 0], up, fovy: 30 } });
const sidewards = view([45, -65, 20]), along = view([3, 5, 90], [0, 1, 0]), inside = view([2, -4, 1]);
const scenes = {
  'unlit dvr': writeJson('unlit.json', sceneOf(volume, {}, sidewards)),
  'lit dvr, along the slabs': writeJson('lit.json', sceneOf(volume, { shading: lit }, along)),
  'isosurfaces': writeJson('surfaces.json', sceneOf(volume, { mode: 'isosurface', shading: lit, isosurfaces: surfaces }, sidewards)),
  'surfaces in dvr': writeJson('both.json', sceneOf(volume, { shading: lit, isosurfaces: surfaces }, along)),
  'surfaces in dvr, from inside': writeJson('inside.json', sceneOf(volume, { shading: lit, isosurfaces: surfaces }, inside)),
  'mip': writeJson('mip.json', sceneOf(volume, { mode: 'mip' }, sidewards)),
};

let count = 0;
async function pixels(args, ranks = 0) {
  const output = inScratch(`picture-${++count}.exr`);
  const made = await (ranks ? runRanks(ranks, ['render', ...args, '-o', output]) : run(['render', ...args, '-o', output]));
  assert.equal(made.status, 0, made.stderr);
  return output;
}
async function expectSame(scene, size, quality, options, ranks = 0) {
  const whole = await pixels([scene, '--size', size, ...quality, '--threads', '1']);
  const slabs = await pixels([scene, '--size', size, ...quality, ...options], ranks);
  const compared = await runCommand('idiff', ['-fail', '0', '-warn', '0', whole, slabs]);
  assert.equal(compared.status, 0, `${options} ${compared.stdout}`);
}

if (how === 'loopback') {
  for (const [name, scene] of Object.entries(scenes)) {
    test(`${name}: slabs give the picture of the whole`, async () => {
      const image = inScratch('seen.png');
      assert.equal((await run(['render', scene, '-o', image, '--size', '157x123'])).status, 0);
      assert.ok(covered(readPng(image)) > 0.05, 'the picture is empty');
      await expectSame(scene, '157x123', [], ['--workers', '2', '--data', 'slabs']);
      await expectSame(scene, '157x123', [], ['--workers', '5', '--data', 'slabs:3', '--threads', '2']);
      await expectSame(scene, '157x123', ['--sampling', 'every-pixel'], ['--workers', '5', '--data', 'slabs:5']);
    });
  }
  test('One slab is the whole', () => expectSame(scenes['lit dvr, along the slabs'], '97x64', [], ['--data', 'slabs:1']));
  test('Refinement to a small error is the same', () =>
    expectSame(scenes['surfaces in dvr'], '97x64', ['--error', '0.1'], ['--workers', '3', '--data', 'slabs']));
  const refuses = async (options, status, word) => {
    const result = await run(['render', scenes.mip, '-o', inScratch('never.png'), ...options]);
    assert.deepEqual(errorLines(result).map((line) => word.test(line)), [true], result.stderr);
    assert.equal(result.status, status);
    assert.ok(!existsSync(inScratch('never.png')));
  };
  test('More slabs than workers are refused', () => refuses(['--workers', '2', '--data', 'slabs:3'], 2, /--data: 3 slabs need as many workers/));
  test('More slabs than layers of cells are refused', () => refuses(['--workers', '6', '--data', 'slabs:6'], 2, /37 slices, too few for 6 slabs/));
  test('Steps too long for slabs are refused', () => refuses(['--workers', '2', '--data', 'slabs', '--step', '9'], 2, /--step: is so long that rays leave their slab/));
} else if (how === 'mpi') {
  test('Slabs under mpirun give the picture of the whole', async () => {
    await expectSame(scenes['surfaces in dvr'], '157x123', [], ['--data', 'slabs', '--threads', '1'], 5);
    await expectSame(scenes['unlit dvr'], '157x123', [], ['--data', 'slabs:2', '--threads', '1', '--compositors', '2'], 7);
  });
  test('The head in four slabs is the head', { skip: existsSync(headVolume) ? false : 'no head is installed' }, () =>
    expectSame(headScene, '201x153', [], ['--data', 'slabs:4', '--threads', '1'], 6));
  const killed = async (slabs) => {
    const args = (output) => ['render', scenes['surfaces in dvr'], '-o', inScratch(output), '--size', '200x150', '--error', '0.1',
                              '--step', '0.008', '--threads', '1'];
    const render = startRecoverable(6, [...args('killed.png'), '--data', slabs], inScratch('status'), { seconds: 150 });
    await render.until(() => /rendering: [0-7]?\d %/.test(render.stderr));
    process.kill(processOfRank(render, 3), 'SIGKILL');
    const result = await render.ended;
    return { result, status: readFileSync(inScratch('status'), 'utf8').trim(), args };
  };
  test('A worker that dies is stood in for by one with the same slab', async () => {
    const { result, status, args } = await killed('slabs:2');
    assert.equal(status, '0', result.stderr);
    assert.match(result.stderr, /rank 3, a worker, has gone silent/);
    assert.equal((await run(args('whole.png'), { seconds: 150 })).status, 0);
    assert.ok(readPng(inScratch('killed.png')).rgb.equals(readPng(inScratch('whole.png')).rgb));
    assert.deepEqual(await leftOver(), []);
  });
  test('A slab that dies with its only worker is told of', async () => {
    const { result, status } = await killed('slabs:4');
    assert.equal(status, '4', result.stderr);
    assert.equal(errorLines(result).length, 1, result.stderr);
    assert.match(errorLines(result)[0], /rank 3.* a slab of the volume that nobody else holds/);
    assert.deepEqual(await leftOver(), []);
  });
} else {
  const gib = 2 ** 30;
  const { bavail, bsize } = statfsSync(scratch);
  const skip = bavail * bsize < 6 * gib ? 'there is no room for 4 GiB in the temporary folder'
    : freemem() < 6 * gib && 'there is not enough memory free';
  test('4 GiB of voxels in four slabs take less than 1.5 GiB in each rank', { skip }, async () => {
    const file = inScratch('gyroid_1626x1626x1626_uint8.raw');
    try {
      const tool = path.join(path.dirname(program), 'goldthread-synthetic');
      const written = await runCommand(tool, [file], { seconds: 200 });
      assert.equal(written.status, 0, written.stderr);
      const scene = writeJson('large.json', sceneOf(file, {
        shading: lit, isosurfaces: [{ value: 150, color: [0.3, 0.6, 0.9], opacity: 0.3 }, { value: 190, color: [0.9, 0.7, 0.3], opacity: 0.8 }],
        transferFunction: { unitDistance: 1, color: [[0, 0.1, 0.2, 0.5], [128, 0.9, 0.6, 0.3], [255, 1, 1, 0.9]],
                            opacity: [[0, 0], [120, 0], [200, 0.02], [255, 0.1]] },
      }, { camera: { position: [2600, -3400, 1500], target: [0, 0, 0], up: [0, 0, 1], fovy: 30 } }));
      const image = inScratch('large.png'), report = inScratch('large.report.json');
      const made = await runRanks(6, ['render', scene, '-o', image, '--size', '96x96', '--error', '2', '--data', 'slabs:4',
                                      '--threads', '1', '--report', report], { seconds: 250 });
      assert.equal(made.status, 0, made.stderr);
      assert.ok(covered(readPng(image)) > 0.2, 'the picture is empty');
      const { ranks } = JSON.parse(readFileSync(report, 'utf8'));
      const workers = ranks.filter((rank) => rank.role === 'worker');
      const idle = ranks.find((rank) => rank.role === 'master').peakMemoryBytes;
      assert.equal(workers.length, 4);
      for (const { rank, peakMemoryBytes } of workers) {
        assert.ok(peakMemoryBytes > 1.0 * gib, `rank ${rank} cannot have held its slab`);
        assert.ok(peakMemoryBytes < 1.5 * gib, `rank ${rank} took ${peakMemoryBytes / gib} GiB`);
        const share = (peakMemoryBytes - idle) / (1626 ** 3 / 4);
        assert.ok(share < 1.15, `rank ${rank} took ${share} of its share`);
      }
    } finally {
      rmSync(file, { force: true });
    }
  });
}
