// SPDX-License-Identifier: Apache-2.0
// By-passed roles keep every message: a render whose computing is replaced by stubs ends as any other,
// and its ranks have said as much to each other.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import test from 'node:test';
import { inScratch, run, runRanks } from './support/program.mjs';
import { lit, sceneOf, writeJson, writeNrrd } from './support/data.mjs';
import { covered, readPng } from './support/picture.mjs';

const scene = writeJson('scene.json', sceneOf(writeNrrd('bumps.nrrd'), { shading: lit }));
const kStubs = ['master', 'worker', 'compositor', 'master,worker', 'worker,compositor', 'master,worker,compositor'];

const starts = {
  'in threads': (args) => run([...args, '--workers', '2', '--compositors', '2']),
  'under mpirun': (args) => runRanks(5, [...args, '--compositors', '2']),
};

/** The report of a picture of every pixel, and what was said in the log. */
async function rendered(start, bypass, ...options) {
  const made = await start(['render', scene, '-o', inScratch('picture.png'), '--size', '200x150', '--sampling',
                            'every-pixel', '--tile', '64', '--report', inScratch('report.json'), '--bypass', bypass, ...options]);
  assert.equal(made.status, 0, made.stderr);
  return { report: JSON.parse(readFileSync(inScratch('report.json'), 'utf8')), log: made.stderr };
}

/** Of each kind that follows from the picture alone. */
function counted({ messages }) {
  const kinds = ['BeginView', 'Samples', 'BandReady', 'CollectBand', 'BandPicture'];
  return Object.fromEntries(kinds.map((kind) => [kind, messages[kind]]));
}

/** Rays that workers have reported, tile by tile and step by step. */
const reported = ({ frames }) => frames.map(({ rays }) => rays);

let stub;  // what all runs report whose workers are by-passed, however they are started
for (const [how, start] of Object.entries(starts)) {
  test(`By-passed roles send as many messages as those that compute, ${how}`, async () => {
    const { report: real, log } = await rendered(start, 'none');
    assert.deepEqual(real.bypassed, []);
    assert.doesNotMatch(log, /by-passed/);
    assert.equal(counted(real).Samples, 3 * 12);
    assert.ok(covered(readPng(inScratch('picture.png'))) > 0.05, 'nothing to see');
    for (const bypass of kStubs) {
      const { report, log: warned } = await rendered(start, bypass);
      assert.deepEqual(report.bypassed, bypass.split(','));
      assert.equal(warned.match(/by-passed: .*/g).length, 1, warned);
      assert.deepEqual(counted(report), counted(real), bypass);
      // Each tile's part is in the sum; the stub casts one ray for each place that it sends, the same each time.
      if (bypass.includes('worker')) stub ??= reported(report);
      assert.deepEqual(reported(report), bypass.includes('worker') ? stub : reported(real), bypass);
      // One report tells of all that was done at once.
      const reports = report.messages.TilesDone;
      assert.ok(reports >= 3 && reports <= real.messages.Samples, `${reports} reports: ${bypass}`);
      assert.equal(report.bytes.Samples, real.bytes.Samples, bypass);
      assert.equal(report.bytes.BandPicture, real.bytes.BandPicture, bypass);
    }
  });
}

test('A by-passed render with options of refinement ends, too', async () => {
  const kAll = ['--size', '100x100', '--bypass', 'master,worker,compositor'];
  for (const options of [['--sampling', 'adaptive'], ['--samples', '5'], ['--orbit', '3']]) {
    const made = await run(['render', scene, '-o', inScratch(options[0] === '--orbit' ? 'stub%d.png' : 'stub.png'), ...kAll, ...options]);
    assert.equal(made.status, 0, made.stderr);
  }
});

test('Frames and a stream of messages are measured in all ranks of an MPI job', async () => {
  const options = ['--quick', '--size', '256x256', '-o', inScratch('ranks')];
  const frames = await runRanks(4, ['bench', 'frames', scene, '--bypass', 'worker,compositor', ...options]);
  assert.equal(frames.status, 0, frames.stderr);
  const measured = JSON.parse(readFileSync(inScratch('ranks/frames.json'), 'utf8'));
  assert.equal(measured.tiles, 16);
  assert.equal(measured.sampleMessages, 16);
  assert.ok(measured.seconds.length >= 5 && measured.seconds.every((s) => s > 0));

  const stream = await runRanks(4, ['bench', 'stream', ...options]);
  assert.equal(stream.status, 0, stream.stderr);
  const { bytes, seconds } = JSON.parse(readFileSync(inScratch('ranks/stream.json'), 'utf8'));
  // As many bytes in a frame's messages as the frame's own samples had.
  assert.equal(bytes % measured.sampleBytes, 0);
  assert.ok(seconds.length >= 3 && seconds.every((s) => s > 0));
});
