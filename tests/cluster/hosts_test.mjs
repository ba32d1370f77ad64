// SPDX-License-Identifier: Apache-2.0
// The program over three hosts: namespaces of this machine, with a network between them. Ends with 77, and
// says why, where there can be none.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { once } from 'node:events';
import { readFileSync } from 'node:fs';
import { readFile } from 'node:fs/promises';
import test, { after } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import { Hosts, whyNoHosts } from './support/hosts.mjs';
import { errorLines, inScratch, leftOver, run } from './support/program.mjs';
import { lit, sceneOf, surfaces, writeJson, writeNrrd } from './support/data.mjs';
import { covered, readPng } from './support/picture.mjs';

const absent = whyNoHosts();
if (absent) {
  console.log(`skipped: ${absent}`);
  process.exit(77);
}

// The master, the compositor and a worker on the first host, two workers on each of the others.
const hosts = new Hosts([3, 2, 2]);
const kRanks = 7;
after(() => hosts.close());

const volume = writeNrrd('bumps.nrrd');
const scene = writeJson('scene.json', sceneOf(volume, { shading: lit, isosurfaces: surfaces }));

let count = 0;
/** Starts a render over all hosts; `finish` waits for its picture. */
function startRender(options) {
  const name = `hosts-${++count}`;
  const [picture, report] = ['png', 'json'].map((extension) => inScratch(`${name}.${extension}`));
  const render = hosts.startRanks(kRanks, ['render', scene, '-o', picture, '--report', report, '--threads', '1', ...options],
                                  { seconds: 150 });
  return Object.assign(render, {
    async finish() {
      const result = await render.ended;
      assert.equal(result.status, 0, result.stderr);
      return { ...result, picture: readPng(picture), report: JSON.parse(readFileSync(report, 'utf8')) };
    },
  });
}

const references = new Map();
/** What one process makes. */
async function alone(options) {
  const key = options.join(' ');
  if (!references.has(key)) {
    const output = inScratch(`alone-${++count}.png`);
    const made = await run(['render', scene, '-o', output, ...options], { seconds: 150 });
    assert.equal(made.status, 0, made.stderr);
    references.set(key, readPng(output));
    assert.ok(covered(references.get(key)) > 0.05, 'the reference is empty');
  }
  return references.get(key);
}

test('A picture of three hosts is that of one process, to the bit', async () => {
  const options = ['--size', '301x197'];
  const { picture, report, stderr } = await startRender(options).finish();
  assert.ok(picture.rgb.equals((await alone(options)).rgb));
  assert.deepEqual(report.ranks.map(({ host }) => hosts.names.indexOf(host)), [0, 0, 0, 1, 1, 2, 2], stderr);
  const cast = new Set(report.tiles.map(({ worker }) => report.ranks[worker].host));
  assert.deepEqual([...cast].sort(), hosts.names, 'each host has cast a part of it');
});

/** The blocks of memory that a process has mapped a volume from, by device and number of the file. */
const volumeBlocks = (pid) =>
  [...new Set(readFileSync(`/proc/${pid}/maps`, 'utf8').split('\n').filter((line) => line.includes('memfd:goldthread volume'))
    .map((line) => line.split(/\s+/).slice(3, 5).join(' ')))];

test('A session over three hosts answers pages, and each host holds the volume once', async () => {
  const session = hosts.startRanks(kRanks, ['serve', scene, '--port', '0', '--size', '64x64']);
  await session.until(() => /http:\S+\n/.test(session.stdout) && session.stderr.includes('values 0'));
  const url = session.stdout.match(/http:\S+/)[0];
  const ask = `fetch(${JSON.stringify(url)}).then(async (answer) => console.log(answer.status, await answer.text()))`;
  const page = await hosts.start(0, process.execPath, ['-e', ask], { seconds: 20 }).ended;
  assert.match(page.stdout, /^200 <!doctype html>/i, page.stderr);

  // A file that is mapped is the same for all ranks of a host, and another on each.
  const seen = hosts.names.map((_, i) => hosts.ranks(i).flatMap(volumeBlocks));
  assert.deepEqual(seen.map((blocks) => blocks.length), [1, 2, 2], 'workers of each host that have mapped it');
  assert.deepEqual(seen.map((blocks) => new Set(blocks).size), [1, 1, 1]);
  assert.equal(new Set(seen.flat()).size, 3);

  session.signal('SIGTERM');
  const result = await session.ended;
  assert.equal(result.status, 0, result.stderr);
  assert.deepEqual(errorLines(result), []);
  assert.deepEqual(await leftOver(), []);
});

/** A render that is not half done. A fast machine may be done before there is any progress to tell: then more slowly. */
async function startLong() {
  for (const step of ['0.02', '0.005', '0.001', '0.0002', '0.00005']) {
    const options = ['--size', '128x96', '--error', '0.3', '--step', step];
    const render = startRender(options);
    if (await render.until(() => /rendering: [0-5]?\d %/.test(render.stderr)).then(() => true, () => false)) return { render, options };
  }
  throw new Error('every render is done before it is half done');
}

test('A host that is cut off after its work is missed before MPI ends, which would wait for it', async () => {
  const report = inScratch('report.pipe'), picture = inScratch('done.png');
  execFileSync('mkfifo', [report]);
  const options = ['--size', '64x48'];
  // No daemon may tell of it first.
  const render = hosts.startRanks(kRanks, ['render', scene, '-o', picture, '--report', report, '--threads', '1', ...options],
                                  { seconds: 100, env: { OMPI_MCA_oob_tcp_keepalive_time: '600' } });
  const exit = once(render.child, 'exit');
  // Soon after the picture the master begins to write the report, and goes on when somebody reads it.
  await render.until(() => render.stderr.includes(`${picture}: 64×48`));
  await setTimeout(2000);
  hosts.cut(2);
  try {
    const ended = render.ended.then(({ status }) => [status]);
    const told = await Promise.race([readFile(report, 'utf8'), ended.then(() => Promise.reject(new Error('it ended without a report')))]);
    assert.equal(JSON.parse(told).ranks.length, kRanks);
    const [status] = await Promise.race([exit, ended]);
    assert.equal(status, 0, render.stderr);
    assert.deepEqual(errorLines(render), []);
    assert.ok(readPng(picture).rgb.equals((await alone(options)).rgb));
  } finally {
    hosts.restore(2);
  }
  assert.deepEqual(await leftOver(), []);
});

const ways = {
  'is lost': (i) => hosts.kill(i),
  'is cut off': (i) => hosts.cut(i),
  'is cut off until TCP gives up': (i) => {
    hosts.giveUpSoon();
    hosts.cut(i);
  },
};
for (const [way, lose] of Object.entries(ways)) {
  test(`A host of workers that ${way} in the middle of a picture changes no bit of it`, async () => {
    const { render, options } = await startLong();
    try {
      lose(2);
      const { picture, stderr } = await render.finish();
      for (const rank of [5, 6]) assert.match(stderr, new RegExp(`rank ${rank}, a worker, has gone silent`));
      assert.ok(picture.rgb.equals((await alone(options)).rgb));
      // Also those that were cut off: their daemon sees to it.
      assert.deepEqual(await leftOver(), []);
    } finally {
      hosts.restore(2);
    }
  });
}
