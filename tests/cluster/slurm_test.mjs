// SPDX-License-Identifier: Apache-2.0
// launch/slurm.sbatch under a real Slurm of three nodes. Ends with 77, and says why, where there is none.

import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import test, { after, before } from 'node:test';
import { Hosts, whyNoHosts } from './support/hosts.mjs';
import { Slurm, whyNoSlurm } from './support/slurm.mjs';
import { errorLines, inScratch, program, run, sourceDirectory } from './support/program.mjs';
import { lit, sceneOf, writeJson, writeNrrd } from './support/data.mjs';
import { covered, readPng } from './support/picture.mjs';

const absent = whyNoHosts() || whyNoSlurm();
if (absent) {
  console.log(`skipped: ${absent}`);
  process.exit(77);
}

const hosts = new Hosts([2, 2, 2]);
let slurm;
before(async () => { slurm = await Slurm.start(hosts); });
after(async () => {
  await slurm?.close();
  hosts.close();
});

const scene = writeJson('scene.json', sceneOf(writeNrrd('bumps.nrrd'), { shading: lit }));
const options = ['--size', '301x197'];

let jobs = 0;
/** Submits the script as a user does, from the repository's folder, and waits: {status, log}. */
async function submit(args, { onLog } = {}) {
  const file = inScratch(`job-${++jobs}.log`);
  const batch = slurm.start('sbatch', ['--wait', '--nodes=3', '--ntasks=5', `--output=${file}`, 'launch/slurm.sbatch', ...args],
                            { env: { GOLDTHREAD_PROGRAM: program }, cwd: sourceDirectory, seconds: 180 });
  const read = () => existsSync(file) ? readFileSync(file, 'utf8') : '';
  let ended = false;
  batch.ended.finally(() => { ended = true; }).catch(() => {});
  while (onLog && !ended && !onLog(read())) await new Promise((resolve) => setTimeout(resolve, 50));
  const { status } = await batch.ended;
  return { status, log: read() };
}

async function alone(extra = []) {
  const made = await run(['render', scene, '-o', inScratch('alone.png'), ...options, ...extra], { seconds: 80 });
  assert.equal(made.status, 0, made.stderr);
  const picture = readPng(inScratch('alone.png'));
  assert.ok(covered(picture) > 0.05, 'the reference is empty');
  return picture;
}

test('A job of three nodes makes the picture of one process, to the bit', async () => {
  const [picture, report] = [inScratch('slurm.png'), inScratch('slurm.report')];
  const { status, log } = await submit(['render', scene, '-o', picture, '--report', report, ...options]);
  assert.equal(status, 0, log);
  // The master and the compositor, which serves the page, on the first host, workers on all.
  const { ranks } = JSON.parse(readFileSync(report, 'utf8'));
  const at = ranks.map(({ host }) => hosts.names.indexOf(host));
  assert.deepEqual(at.slice(0, 2), [0, 0]);
  assert.deepEqual([...new Set(at)].sort(), [0, 1, 2]);
  assert.ok(readPng(picture).rgb.equals((await alone()).rgb));
});

test('A job ends with the status of the program, and its log has the one line', async () => {
  const { status, log } = await submit(['render', inScratch('no.json'), '-o', inScratch('never.png')]);
  assert.equal(status, 3, log);
  assert.equal(errorLines({ stderr: log }).length, 1, log);
});

/** Kills a rank of the job that runs; false if it is not there. */
function killRank(rank) {
  const [pid] = hosts.names.flatMap((_, i) => hosts.ranks(i)).filter((candidate) =>
    readFileSync(`/proc/${candidate}/environ`, 'utf8').split('\0').includes(`OMPI_COMM_WORLD_RANK=${rank}`));
  if (pid) process.kill(pid, 'SIGKILL');
  return Boolean(pid);
}

test('A worker that is killed in the middle of a picture changes no bit of it, nor the status', async () => {
  const picture = inScratch('killed.png');
  let extra, result;
  for (const step of ['0.01', '0.002', '0.0004', '0.0001']) {
    extra = ['--error', '0.3', '--step', step];
    result = await submit(['render', scene, '-o', picture, '--threads', '1', ...options, ...extra], {
      onLog: (log) => /rendering: [0-5]?\d %/.test(log) && killRank(4),
    });
    if (/rank 4, a worker, has gone silent/.test(result.log)) break;
  }
  assert.match(result.log, /rank 4, a worker, has gone silent/);
  assert.equal(result.status, 0, result.log);
  assert.ok(readPng(picture).rgb.equals((await alone(extra)).rgb));
});
