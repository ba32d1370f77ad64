// SPDX-License-Identifier: Apache-2.0
// Compression between hosts: on where the link makes it pay, off where not, and the picture is the same.
// Ends with 77, and says why, where there can be no hosts.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import test, { after } from 'node:test';
import { Hosts, whyNoHosts } from './support/hosts.mjs';
import { inScratch, run } from './support/program.mjs';
import { sceneOf, writeJson, writeNrrd } from './support/data.mjs';
import { covered, readPng } from './support/picture.mjs';

const absent = whyNoHosts();
if (absent) {
  console.log(`skipped: ${absent}`);
  process.exit(77);
}

// The master, the compositor and two workers, so that samples and bands both go through the network.
const hosts = new Hosts([1, 1, 2]);
after(() => hosts.close());

// Rays that cost little and fill the picture: the network is what the frames wait for.
const scene = writeJson('scene.json', sceneOf(writeNrrd('bumps.nrrd'), {},
  { camera: { position: [12, -22, 10], target: [0, 0, 0], up: [0, 0, 1], fovy: 30 } }));
const kFrames = 3, kPairs = 5;
const options = ['--size', '512x512', '--sampling', 'every-pixel', '--samples', '2', '--step', '2', '--threads', '1',
                 '--orbit', `${kFrames},30`];

let count = 0;
/** Renders the frames over the hosts: their pictures, the links of the report, the time of the best frame. */
async function frames(compress) {
  const name = `run-${++count}`;
  const report = inScratch(`${name}.report`);
  const made = await hosts.startRanks(4, ['render', scene, '-o', inScratch(`${name}-%d.png`), '--report', report,
    '--compress', compress, ...options], { seconds: 100 }).ended;
  assert.equal(made.status, 0, made.stderr);
  const { frames: timed, links } = JSON.parse(readFileSync(report, 'utf8'));
  return { name, links, seconds: Math.min(...timed.map(({ seconds }) => seconds)) };
}

const alone = inScratch('alone-%d.png');
test('The frames are there to compare with', async () => {
  const made = await run(['render', scene, '-o', alone, ...options], { seconds: 100 });
  assert.equal(made.status, 0, made.stderr);
  assert.ok(covered(readPng(alone.replace('%d', '0'))) > 0.5, 'hardly anything to send');
});
function expectSame({ name }) {
  for (let i = 0; i < kFrames; ++i)
    assert.ok(readPng(inScratch(`${name}-${i}.png`)).rgb.equals(readPng(alone.replace('%d', String(i))).rgb), `${name} ${i}`);
}

const told = ({ from, to, megabytesPerSecond, ratio, compressMegabytesPerSecond, decompressMegabytesPerSecond, messages,
                compressed, rawBytes, sentBytes }) =>
  `# link ${from} → ${to}: ${megabytesPerSecond.toFixed(0)} MB/s; codec ${ratio.toFixed(2)}, ` +
  `${compressMegabytesPerSecond.toFixed(0)} and ${decompressMegabytesPerSecond.toFixed(0)} MB/s; ` +
  `${compressed} of ${messages} compressed, ${(1e-6 * rawBytes).toFixed(1)} MB as ${(1e-6 * sentBytes).toFixed(1)} MB`;

/** The links of a run with auto, and how much faster its frames were than without: the median of some pairs. */
async function compare(rate) {
  hosts.shape(rate);
  const gains = [];
  let links;
  for (let pair = 0; pair < kPairs; ++pair) {
    const off = await frames('off');
    const auto = await frames('auto');
    for (const made of [off, auto]) expectSame(made);
    assert.ok(off.links.every(({ compressed, rawBytes, sentBytes }) => compressed === 0 && rawBytes === sentBytes));
    gains.push(off.seconds / auto.seconds);
    links = auto.links;
    console.log(`# ${rate ?? 'not shaped'}: ${off.seconds.toFixed(3)} s off, ${auto.seconds.toFixed(3)} s auto, ratio ${gains.at(-1).toFixed(2)}`);
  }
  console.log(links.map(told).join('\n'));
  return { links, gain: gains.toSorted((a, b) => a - b)[Math.floor(kPairs / 2)] };
}
const isMostlyOn = ({ rawBytes, sentBytes }) => sentBytes < 0.8 * rawBytes;

test('On 100 Mbit/s frames come earlier by compression', async () => {
  const { links, gain } = await compare('100mbit');
  assert.ok(links.every(isMostlyOn));
  assert.ok(gain > 1.5, `${gain}`);
});

test('On 1 Gbit/s it is found to pay', async () => {
  const { links, gain } = await compare('1gbit');
  assert.ok(links.every(isMostlyOn));
  assert.ok(gain > 1, `${gain}`);
  // The workers share the compositor's link, and bursts of 256 kB go faster.
  for (const { megabytesPerSecond } of links)
    assert.ok(megabytesPerSecond > 15 && megabytesPerSecond < 180, `${megabytesPerSecond} MB/s`);
});

test('On a link that is not shaped it is found not to', async () => {
  const { links } = await compare();
  assert.ok(links.every(({ compressed }) => compressed === 0));
});

test('Compressed by order, the picture is the same', async () => {
  const on = await frames('on');
  expectSame(on);
  assert.ok(on.links.every(isMostlyOn));
});
