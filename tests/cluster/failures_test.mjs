// SPDX-License-Identifier: Apache-2.0
// What goes wrong is told in one line, ends with the documented status and leaves nothing behind.
// Arguments: "process", or "mpi".

import assert from 'node:assert/strict';
import { existsSync, mkdirSync, readFileSync, readdirSync, rmSync, statSync, truncateSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { once } from 'node:events';
import test from 'node:test';
import { gzipSync } from 'node:zlib';
import { errorLines, inScratch, leftOver, processOfRank, program, run, runCommand, runRanks, scratch, start,
         startRanks, startRecoverable } from './support/program.mjs';
import { camera, sceneOf, writeJson, writeNrrd } from './support/data.mjs';
import { covered, readPng } from './support/picture.mjs';

const mpi = process.argv[2] === 'mpi';
const runAll = mpi ? (args, options) => runRanks(3, args, options) : run;
const startAll = mpi ? (args, options) => startRanks(3, args, options) : start;

const volume = writeNrrd('bumps.nrrd');
const scene = writeJson('scene.json', sceneOf(volume));
const raw = (name, bytes) => {
  writeFileSync(inScratch(name), Buffer.alloc(bytes, 7));
  return inScratch(name);
};
const nrrd = (name, sizes, bytes) => {
  const file = inScratch(name);
  writeFileSync(file, `NRRD0004\ntype: float\nendian: little\ndimension: 3\nsizes: ${sizes}\nencoding: raw\n\n`);
  if (bytes) truncateSync(file, bytes);
  return file;
};
const badScene = (name, keys) => writeJson(name, sceneOf(volume, {}, keys));
const truncated = () => {
  const header = Buffer.alloc(352);
  header.writeInt32LE(348, 0);
  [3, 64, 64, 64, 1, 1, 1, 1].forEach((n, i) => header.writeInt16LE(n, 40 + 2 * i));
  header.writeInt16LE(2, 70);
  header.writeInt16LE(8, 72);
  for (let i = 0; i < 8; ++i) header.writeFloatLE(1, 76 + 4 * i);
  header.writeFloatLE(352, 108);
  header.write('n+1\0', 344, 'latin1');
  const noise = Buffer.from(Array.from({ length: 64 ** 3 }, (_, i) => (i * 2654435761) >>> 24));
  const whole = gzipSync(Buffer.concat([header, noise]));
  writeFileSync(inScratch('short.nii.gz'), whole.subarray(0, whole.length / 2));
  return inScratch('short.nii.gz');
};

/** The command ends with `status` and one line that matches all of `words`; no new file is there. */
async function expectFailure(args, status, ...words) {
  const before = readdirSync(scratch).sort();
  const result = await runAll(args);
  const lines = errorLines(result);
  assert.equal(lines.length, 1, `${result.line}\n${result.stderr}`);
  for (const word of words) assert.match(lines[0], word);
  assert.equal(result.status, status, result.stderr);
  assert.equal(result.stdout, '');
  assert.deepEqual(readdirSync(scratch).sort(), before);
  return result;
}
const expectBadInput = (input, ...words) =>
  expectFailure(['render', input, '-o', inScratch('never.png')], 3, ...words);

test('A scene that is not there is bad input', () => expectBadInput(inScratch('no.json'), /no\.json: there is no such file/));
test('A truncated volume is bad input', () => expectBadInput(truncated(), /short\.nii\.gz: .*truncated/));
test('An unknown key names the nearest known one', () =>
  expectBadInput(badScene('key.json', { lihgts: [] }), /key\.json: lihgts: unknown key .*"lights"/));
test('An output whose folder is not there is found before the volume is read', async () => {
  const result = await expectFailure(['render', scene, '-o', inScratch('no/x.png')], 4, /no\/x\.png: cannot be written/);
  assert.doesNotMatch(result.stderr, /values 0/);
});
test('--help and --version never start MPI', async () => {
  // With these MPI_Init fails.
  const broken = { env: { OMPI_MCA_pml: 'nonsense', OMPI_MCA_btl: 'nonsense' } };
  for (const args of [['--version'], ['render', '--help'], ['--help']]) {
    const result = await runAll(args, broken);
    assert.equal(result.status, 0, result.stderr);
    assert.match(result.stdout, /goldthread/);
    assert.equal(result.stdout, (await run(args)).stdout, 'told once');
  }
});

if (mpi) {
  const expectUsage = async (ranks, options, word) => {
    const result = await runRanks(ranks, ['render', scene, '-o', inScratch('never.png'), ...options]);
    assert.deepEqual(errorLines(result).map((line) => word.test(line)), [true], result.stderr);
    assert.equal(result.status, 2);
    assert.ok(!existsSync(inScratch('never.png')));
  };
  test('Two ranks are too few', () => expectUsage(2, [], /too few ranks/));
  test('Compositors that leave no worker are too many', () => expectUsage(4, ['--compositors', '3'], /too few ranks .* 3 compositors/));
  test('--workers is not for mpirun', () => expectUsage(3, ['--workers', '4'], /--workers: .*mpirun/));
  test('An option that is not there is told by one rank', () => expectUsage(3, ['--wrokers', '4'], /--wrokers/));
  test('A worker that is killed in the middle of a picture is told of, and changes no bit of it', async () => {
    const args = (output, step) => ['render', scene, '-o', inScratch(output), '--size', '320x240', '--error', '0.05',
                                    '--step', step, '--threads', '1'];
    // A fast machine may be done before there is any progress to tell, or nearly so: then more slowly.
    let render, step;
    for (step of ['0.0004', '0.0001', '0.00002']) {
      render = startRecoverable(4, args('killed.png', step), inScratch('status'), { seconds: 120 });
      if (await render.until(() => /rendering: [0-7]?\d %/.test(render.stderr)).then(() => true, () => false)) break;
    }
    process.kill(processOfRank(render, 3), 'SIGKILL');
    const result = await render.ended;
    assert.equal(readFileSync(inScratch('status'), 'utf8').trim(), '0', result.stderr);
    assert.match(result.stderr, /rank 3, a worker, has gone silent/);
    const whole = await run(args('whole.png', step), { seconds: 120 });
    assert.equal(whole.status, 0, whole.stderr);
    assert.ok(readPng(inScratch('killed.png')).rgb.equals(readPng(inScratch('whole.png')).rgb));
    assert.deepEqual(await leftOver(), []);
  });
} else {
  test('A folder without images is bad input', () => {
    mkdirSync(inScratch('folder'), { recursive: true });
    return expectBadInput(inScratch('folder'), /folder: /);
  });
  test('Bytes that are no volume are bad input', () => {
    writeFileSync(inScratch('wrong.nii.gz'), 'hello');
    return expectBadInput(inScratch('wrong.nii.gz'), /wrong\.nii\.gz: /);
  });
  test('A scene that is no JSON is bad input', () => expectBadInput(writeJson('broken.json', '{"goldthread": 1,'), /broken\.json: line 1/));
  test('Numbers that are not finite are bad input', async () => {
    const text = JSON.stringify(sceneOf(volume)).replace('"fovy":30', '"fovy":1e999');
    await expectBadInput(writeJson('huge.json', text), /huge\.json: .*number/);
    await expectBadInput(writeJson('nan.json', text.replace('1e999', 'NaN')), /nan\.json: line 1/);
  });
  test('A camera that stands on its target is bad input', () =>
    expectBadInput(badScene('stand.json', { camera: { ...camera, target: camera.position } }), /stand\.json: camera/));
  test('A volume without voxels is bad input', async () => {
    await expectBadInput(raw('none_0x4x4_uint8.raw', 0), /0×4×4/);
    await expectBadInput(raw('empty_4x4x4_uint8.raw', 0), /promises 64 bytes, and it has 0/);
  });
  test('A header that promises too much is bad input', async () => {
    await expectBadInput(nrrd('huge.nrrd', '100000 100000 100000'), /huge\.nrrd: .*2\^40/);
    await expectBadInput(nrrd('long.nrrd', '2000 2000 2000'), /long\.nrrd: /);
  });
  test('A volume of one voxel renders as background', async () => {
    const output = inScratch('one.png');
    const file = raw('one_1x1x1_uint8.raw', 1);
    const result = await run(['render', writeJson('one.json', sceneOf(file)), '-o', output]);
    assert.equal(result.status, 0, result.stderr);
    assert.equal(covered(readPng(output)), 0);
  });
  test('A wrong output is wrong usage', async () => {
    await expectFailure(['render', scene, '-o', inScratch('x.bmpp')], 2, /\.bmpp.*\.png/);
    await expectFailure(['render', scene, '-o', inScratch('x.png'), '--orbit', '3'], 2, /%d/);
  });
  test('A report that cannot be written is found before the picture is made', async () => {
    for (const place of [inScratch('no/report.json'), scratch]) {
      const result = await expectFailure(['render', scene, '-o', inScratch('x.png'), '--report', place], 4,
                                         /cannot be written/);
      assert.doesNotMatch(result.stderr, /values 0/);
    }
  });
  test('A full disk is told', async () => {
    const result = await run(['render', scene, '-o', inScratch('full.png'), '--report', '/dev/full']);
    assert.equal(errorLines(result).length, 1, result.stderr);
    assert.match(errorLines(result)[0], /\/dev\/full: cannot be written/);
    assert.equal(result.status, 4);
  });
  test('A report goes to a pipe too', async () => {
    const result = await runCommand('sh', ['-c', '"$@" | cat', 'sh', program, 'render', scene,
                                           '-o', inScratch('piped.png'), '--report', '/dev/stdout']);
    assert.equal(result.status, 0, result.stderr);
    assert.equal(JSON.parse(result.stdout).frames.length, 1);
  });
  test('A port in use, and a host that is not this one, are told', async () => {
    const server = createServer().listen(0, '127.0.0.1');
    await once(server, 'listening');
    const port = String(server.address().port);
    await expectFailure(['serve', scene, '--port', port], 4, new RegExp(`${port}.*in use`));
    server.close();
    // 192.0.2.0/24 is nobody's (RFC 5737), .invalid too (RFC 2606).
    await expectFailure(['serve', scene, '--host', '192.0.2.1', '--port', '0'], 4, /--host 192\.0\.2\.1/);
    await expectFailure(['serve', scene, '--host', 'nobody.invalid', '--port', '0'], 4, /--host nobody\.invalid/);
  });
}

for (const signal of ['SIGINT', 'SIGTERM']) {
  test(`${signal} ends a session, and every process of it`, async () => {
    const session = startAll(['serve', scene, '--port', '0', '--size', '64x64']);
    await session.until(() => session.stdout.includes('http://') && session.stderr.includes('values 0'));
    session.signal(signal);
    const result = await session.ended;
    assert.deepEqual(errorLines(result), []);
    if (!mpi) assert.equal(result.status, 0, result.stderr);
    assert.deepEqual(await leftOver(), []);
  });
  // mpirun passes a signal on when the volume is long read.
  if (!mpi) test(`${signal} ends a session that still reads its volume`, async () => {
    const large = inScratch('large.nrrd');
    writeFileSync(large, 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 512 512 512\nencoding: raw\n\n');
    truncateSync(large, statSync(large).size + 512 ** 3);
    // On a busy machine a signal may come late: then once more.
    let inTime = false;
    for (let i = 0; i < 5 && !inTime; ++i) {
      const session = start(['serve', large, '--port', '0', '--size', '64x64']);
      await session.until(() => session.stdout.includes('http://'));
      session.signal(signal);
      const result = await session.ended;
      assert.deepEqual(errorLines(result), []);
      assert.equal(result.status, 0, result.stderr);
      inTime = !result.stderr.includes('values 0');
    }
    rmSync(large);
    assert.ok(inTime, 'no signal came while the volume was being read');
    assert.deepEqual(await leftOver(), []);
  });
  test(`${signal} ends a render, which writes nothing`, async () => {
    // Far more than can be done before the signal comes.
    const render = startAll(['render', scene, '-o', inScratch('stopped.png'), '--size', '8192x8192', '--step', '0.001']);
    await render.until(() => render.stderr.includes('values 0'));
    render.signal(signal);
    const result = await render.ended;
    assert.equal(result.signal, null, result.stderr);
    assert.notEqual(result.status, 0);
    // mpirun that was told to end does not pass on what its ranks say last.
    if (!mpi) {
      assert.match(errorLines(result).join('\n'), /was interrupted/);
      assert.equal(result.status, 4);
    }
    assert.ok(!existsSync(inScratch('stopped.png')));
    assert.deepEqual(await leftOver(), []);
  });
}
