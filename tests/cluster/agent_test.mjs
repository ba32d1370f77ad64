// SPDX-License-Identifier: Apache-2.0
// What mpirun hears of hosts through launch/agent: of a start that failed, and not of a host that is lost later.

import assert from 'node:assert/strict';
import { mkdirSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { errorLines, inScratch, Running, sourceDirectory } from './support/program.mjs';

const launch = (name) => path.join(sourceDirectory, 'launch', name);

/** The variables for an ssh that does so instead. */
function withSsh(name, script) {
  const folder = inScratch(name);
  mkdirSync(folder);
  writeFileSync(path.join(folder, 'ssh'), `#!/bin/sh\n${script}\n`, { mode: 0o755 });
  return { PATH: `${folder}:${process.env.PATH}` };
}
const unreachable = withSsh('unreachable', 'echo "$@" >&2; exit 255');
const silenced = withSsh('silenced', 'sleep 16; exit 255');

test('A host that cannot be reached is told of', async () => {
  const { status, stderr } = await new Running(launch('agent'), ['far', 'orted', '-x'], { env: unreachable }).ended;
  assert.equal(status, 255);
  assert.match(stderr, /-o ConnectTimeout=\d+ .*far orted -x\n$/);
});

test('A host that falls silent is not', async () => {
  assert.equal((await new Running(launch('agent'), ['far', 'orted'], { env: silenced }).ended).status, 0);
});

test('Where a host cannot be reached launch/hosts ends with 4 and one line', async () => {
  const hosts = inScratch('hosts');
  writeFileSync(hosts, 'far.invalid slots=3\n');
  const result = await new Running(launch('hosts'), [hosts, '3', 'render', 'scene.json', '-o', 'p.png'],
                                   { env: { ...unreachable, GOLDTHREAD_PROGRAM: '/bin/true' }, seconds: 40 }).ended;
  assert.equal(result.status, 4, result.stderr);
  assert.deepEqual(errorLines(result), ['goldthread: error: launch/hosts: the ranks could not be started or were killed (see above)']);
});
