// SPDX-License-Identifier: Apache-2.0
// Runs the whole program as a user does: in one process or under mpirun, in a folder of its own,
// always with a deadline. What was started is ended with the test, its descendants included.

import { spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';

export const program = process.env.GOLDTHREAD_PROGRAM;
if (!program) throw new Error('GOLDTHREAD_PROGRAM names no program: run the tests with ctest');

export const sourceDirectory = path.resolve(import.meta.dirname ?? path.dirname(new URL(import.meta.url).pathname), '../../..');
export const headScene = path.join(sourceDirectory, 'launch/head.json');
export const headVolume = '/usr/share/mricron/templates/ch2.nii.gz';

/** A folder that is gone when the tests are. Short: shared-memory files of MPI have a limit. */
export const scratch = mkdtempSync(path.join(tmpdir(), 'goldthread-'));
export const inScratch = (name) => path.join(scratch, name);

const groups = new Set();
process.on('exit', () => {
  for (const group of groups) endGroup(group, 'SIGKILL');
  rmSync(scratch, { recursive: true, force: true });
});

for (const signal of ['SIGINT', 'SIGTERM']) process.on(signal, () => process.exit(1));

function endGroup(group, signal) {
  try {
    process.kill(-group, signal);
  } catch {
    // It has ended by itself.
  }
}

/** mpirun says nothing of its own and starts anywhere: as root too, and on few cores. */
export const mpiEnvironment = {
  OMPI_ALLOW_RUN_AS_ROOT: '1', OMPI_ALLOW_RUN_AS_ROOT_CONFIRM: '1',
  OMPI_MCA_pml: 'ob1', OMPI_MCA_btl: 'self,vader',
  OMPI_MCA_btl_vader_single_copy_mechanism: 'none', HWLOC_HIDE_ERRORS: '2',
};

const cleanEnvironment = Object.fromEntries(
  Object.entries(process.env).filter(([name]) => !/^(GOLDTHREAD_(?!PROGRAM)|OMPI_|PMIX_)/.test(name)));

/**
 * A started process: `stdout` and `stderr` grow; `ended` resolves to {status, signal, stdout, stderr}
 * and rejects when `seconds` have passed.
 */
export class Running {
  stdout = '';
  stderr = '';

  constructor(command, args, { env = {}, cwd = scratch, seconds = 60 } = {}) {
    this.line = [path.basename(command), ...args].join(' ');
    this.child = spawn(command, args, {
      cwd, env: { ...cleanEnvironment, ...env }, detached: true, stdio: ['ignore', 'pipe', 'pipe'],
    });
    this.pid = this.child.pid;
    groups.add(this.pid);
    this.child.stdout.setEncoding('utf8').on('data', (text) => { this.stdout += text; });
    this.child.stderr.setEncoding('utf8').on('data', (text) => { this.stderr += text; });
    this.ended = new Promise((resolve, reject) => {
      const deadline = setTimeout(() => {
        endGroup(this.pid, 'SIGKILL');
        reject(new Error(`not done within ${seconds} s: ${this.line}\n${this.stderr}`));
      }, 1000 * seconds);
      this.child.on('error', reject);
      this.child.on('close', (status, signal) => {
        clearTimeout(deadline);
        groups.delete(this.pid);
        resolve({ status, signal, stdout: this.stdout, stderr: this.stderr, line: this.line });
      });
    });
    // Whoever waits sees the rejection; one that nobody waits for must not end the other tests.
    this.ended.catch(() => {});
  }

  signal(name) {
    this.child.kill(name);
  }

  /** Waits until `found()` is true of this process, checked with all that it prints. */
  async until(found) {
    while (!found()) {
      await Promise.race([
        new Promise((resolve) => {
          this.child.stdout.once('data', resolve);
          this.child.stderr.once('data', resolve);
        }),
        this.ended.then((result) => {
          if (!found()) throw new Error(`ended too early (${result.status}): ${this.line}\n${this.stderr}`);
        }),
      ]);
    }
  }
}

export const start = (args, options) => new Running(program, args, options);
export const startRanks = (ranks, args, options = {}) =>
  new Running('mpirun', ['--oversubscribe', '--bind-to', 'none', '-n', String(ranks), program, ...args],
              { ...options, env: { ...mpiEnvironment, ...options.env } });
/** As launch/run does: a rank that dies does not end the others, and the master's status comes back in a file. */
export const startRecoverable = (ranks, args, statusFile, options = {}) =>
  new Running('mpirun', ['--enable-recovery', '--oversubscribe', '--bind-to', 'none',
                         '-n', '1', path.join(sourceDirectory, 'launch/master'), statusFile, program, ...args, ':',
                         '-n', String(ranks - 1), program, ...args],
              { ...options, env: { ...mpiEnvironment, ...options.env } });

/** Runs to the end. */
export const run = (args, options) => start(args, options).ended;
export const runRanks = (ranks, args, options) => startRanks(ranks, args, options).ended;
export const runCommand = (command, args, options) => new Running(command, args, options).ended;

/** The lines that report an error. */
export const errorLines = (result) =>
  result.stderr.split('\n').filter((line) => line.startsWith('goldthread: error: '));

/** Command lines of the processes that still run the program in this test's folder: a rank that was
    told to end may finish what it computes, so they have some seconds to go. */
export async function leftOver() {
  const end = Date.now() + 15_000;
  let found = running();
  while (found.length > 0 && Date.now() < end) {
    await new Promise((resolve) => setTimeout(resolve, 50));
    found = running();
  }
  return found;
}

/** The process that is this rank of a started mpirun. */
export function processOfRank(mpirun, rank) {
  for (const child of readFileSync(`/proc/${mpirun.pid}/task/${mpirun.pid}/children`, 'utf8').trim().split(' ')) {
    const environment = readFileSync(`/proc/${child}/environ`, 'utf8').split('\0');
    if (environment.includes(`OMPI_COMM_WORLD_RANK=${rank}`)) return Number(child);
  }
  throw new Error(`no process is rank ${rank}`);
}

function running() {
  const found = [];
  for (const entry of readdirSync('/proc')) {
    if (!/^\d+$/.test(entry) || Number(entry) === process.pid) continue;
    try {
      const line = readFileSync(`/proc/${entry}/cmdline`, 'utf8').replaceAll('\0', ' ');
      if (line.includes(scratch) && line.includes(program)) found.push(`${entry}: ${line}`);
    } catch {
      // It ended while being looked at.
    }
  }
  return found;
}
