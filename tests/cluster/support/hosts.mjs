// SPDX-License-Identifier: Apache-2.0
// Several hosts on this machine: each a network namespace with a name, an address, a temporary folder and
// shared memory of its own, joined by a bridge that is a namespace too, so that this machine's own network
// is never touched. What they have in common is the file system and the table of processes. Their names
// hold this test's process id; what a test that was killed left behind is cleared away by the next.

import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { inScratch, program, Running, sourceDirectory } from './program.mjs';

const kPrefix = 'goldthread-';
const ip = (...args) => execFileSync('ip', args, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });
const spaces = () => ip('netns', 'list').split('\n').map((line) => line.split(' ')[0]).filter(Boolean);
const processesIn = (space) => ip('netns', 'pids', space).split('\n').filter(Boolean).map(Number);

function end(pid) {
  try {
    process.kill(pid, 'SIGKILL');
  } catch {
    // It has ended by itself.
  }
}

function remove(space) {
  for (const pid of processesIn(space)) end(pid);
  ip('netns', 'delete', space);
}

const lives = (pid) => {
  try {
    return process.kill(pid, 0);
  } catch {
    return false;
  }
};

function removeLeftOver() {
  for (const space of spaces()) {
    const owner = space.match(/^goldthread-(\d+)-/)?.[1];
    if (owner && !lives(Number(owner))) remove(space);
  }
}

/** Why there can be no hosts here; empty if there can. */
export function whyNoHosts() {
  if (process.getuid() !== 0) return 'only root may make network namespaces';
  const trial = `${kPrefix}${process.pid}-trial`;
  try {
    ip('netns', 'add', trial);
    ip('-n', trial, 'link', 'add', 'bridge', 'type', 'bridge');
    ip('-n', trial, 'link', 'add', 'one', 'type', 'veth', 'peer', 'name', 'two');
    execFileSync('unshare', ['--uts', '--mount', 'true']);
    return '';
  } catch (error) {
    return `no network namespaces here: ${error.stderr?.toString().trim() || error.message}`;
  } finally {
    if (spaces().includes(trial)) remove(trial);
  }
}

/** `slots[i]` ranks fit on the i-th host. To be closed. */
export class Hosts {
  #switch = `${kPrefix}${process.pid}-switch`;

  constructor(slots) {
    removeLeftOver();
    process.on('exit', () => this.close());
    this.names = slots.map((_, i) => `${kPrefix}${process.pid}-${i + 1}`);
    this.addresses = slots.map((_, i) => `10.83.77.${i + 1}`);
    this.#write('hosts', this.names.map((name, i) => `${this.addresses[i]} ${name}\n`).join('') + '127.0.0.1 localhost\n');
    this.hostfile = this.#write('hostfile', this.names.map((name, i) => `${name} slots=${slots[i]}\n`).join(''));
    // A process of a host. It is that of the outside, but for the network, the names and shared memory.
    this.enter = this.#script('enter', `host=$1
shift
exec nsenter --net="/run/netns/$host" unshare --uts --mount sh -c '
  hostname "$0" && mount --bind ${inScratch('hosts')} /etc/hosts && mount -t tmpfs none /dev/shm || exit 4
  export TMPDIR="${inScratch('tmp')}/$0"
  exec "$@"' "$host" "$@"`);
    // What mpirun takes for ssh. Ends well whatever came of the host: a lost one is no start that failed.
    this.agent = this.#script('agent', `host=$1
shift
${this.enter} "$host" sh -c "$*"
exit 0`);
    ip('netns', 'add', this.#switch);
    ip('-n', this.#switch, 'link', 'add', 'bridge', 'type', 'bridge');
    ip('-n', this.#switch, 'link', 'set', 'bridge', 'up');
    this.names.forEach((name, i) => this.#add(name, `port${i + 1}`, this.addresses[i]));
  }

  #write(name, text, mode = 0o644) {
    writeFileSync(inScratch(name), text, { mode });
    return inScratch(name);
  }
  #script(name, body) {
    return this.#write(name, `#!/bin/sh\n${body}\n`, 0o755);
  }

  #add(name, port, address) {
    mkdirSync(path.join(inScratch('tmp'), name), { recursive: true });
    ip('netns', 'add', name);
    ip('-n', name, 'link', 'set', 'lo', 'up');
    ip('-n', this.#switch, 'link', 'add', port, 'type', 'veth', 'peer', 'name', 'eth0', 'netns', name);
    ip('-n', this.#switch, 'link', 'set', port, 'master', 'bridge', 'up');
    ip('-n', name, 'address', 'add', `${address}/24`, 'dev', 'eth0');
    ip('-n', name, 'link', 'set', 'eth0', 'up');
  }

  /** Limits what each host sends and gets, such as '1gbit'; without a rate, no longer. */
  shape(rate) {
    const change = (space, device) => {
      const limit = rate ? ['tbf', 'rate', rate, 'burst', '256kb', 'latency', '20ms'] : ['noqueue'];
      execFileSync('tc', ['-n', space, 'qdisc', 'replace', 'dev', device, 'root', ...limit]);
    };
    this.names.forEach((name, i) => {
      change(name, 'eth0');
      change(this.#switch, `port${i + 1}`);
    });
  }

  /** A command on the i-th host. */
  start(i, command, args, options) {
    return new Running(this.enter, [this.names[i], command, ...args], options);
  }

  /** The program on all hosts, started from the first, filled in turn, by launch/hosts: it ends with the master's status. */
  startRanks(ranks, args, options = {}) {
    const network = '10.83.77.0/24';
    return this.start(0, path.join(sourceDirectory, 'launch/hosts'), [this.hostfile, String(ranks), ...args], {
      ...options,
      env: {
        GOLDTHREAD_PROGRAM: program, HWLOC_HIDE_ERRORS: '2', OMPI_MCA_plm_rsh_agent: this.agent,
        OMPI_MCA_btl_tcp_if_include: network, OMPI_MCA_oob_tcp_if_include: network, ...options.env,
      },
    });
  }

  /** The ranks on the i-th host that compute, talk or hand out work. */
  ranks(i) {
    return processesIn(this.names[i]).filter((pid) => {
      try {
        return readFileSync(`/proc/${pid}/cmdline`, 'utf8').split('\0')[0] === program;
      } catch {
        return false;
      }
    });
  }

  /** Everything on the i-th host ends at once, as when its power fails. */
  kill(i) {
    this.cut(i);
    for (const pid of processesIn(this.names[i])) end(pid);
  }
  /** Nothing comes from the i-th host any more, or gets there; it does not know. */
  cut(i) {
    ip('-n', this.#switch, 'link', 'set', `port${i + 1}`, 'down');
  }
  /** TCP gives a silent peer up after some 3 s from now on, instead of a quarter of an hour. */
  giveUpSoon() {
    for (const name of this.names) ip('netns', 'exec', name, 'sysctl', '-q', '-w', 'net.ipv4.tcp_retries2=3');
  }
  /** The i-th host as it was at first, without processes. */
  restore(i) {
    for (const pid of processesIn(this.names[i])) end(pid);
    ip('-n', this.#switch, 'link', 'set', `port${i + 1}`, 'up');
  }

  close() {
    const there = spaces();
    for (const space of [...this.names, this.#switch]) if (there.includes(space)) remove(space);
  }
}
