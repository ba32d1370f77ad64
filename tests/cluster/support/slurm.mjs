// SPDX-License-Identifier: Apache-2.0
// A Slurm of a test's own on its hosts (hosts.mjs): munge, a controller on the first host and a node on each,
// as processes of the test, with everything they write in its folder.

import { execFileSync } from 'node:child_process';
import { randomBytes } from 'node:crypto';
import { mkdirSync, writeFileSync } from 'node:fs';
import { inScratch } from './program.mjs';

const kDeadline = 900;

/** Why there can be no Slurm here; empty if there can. */
export function whyNoSlurm() {
  if (process.getuid() !== 0) return 'only root may start Slurm';
  for (const command of ['munged', 'slurmctld', 'slurmd', 'sbatch']) {
    try {
      execFileSync('sh', ['-c', `PATH=$PATH:/usr/sbin command -v ${command}`]);
    } catch {
      return `${command} is not installed (Debian: slurmctld, slurmd, slurm-client, munge)`;
    }
  }
  return '';
}

function configuration(folder, { names, addresses }) {
  return `ClusterName=goldthread
SlurmctldHost=${names[0]}(${addresses[0]})
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=${folder}/munge.socket
CredType=cred/munge
StateSaveLocation=${folder}/state
SlurmdSpoolDir=${folder}/spool-%n
SlurmctldPidFile=${folder}/slurmctld.pid
SlurmdPidFile=${folder}/slurmd-%n.pid
SlurmctldLogFile=${folder}/slurmctld.log
SlurmdLogFile=${folder}/slurmd-%n.log
TmpFS=${folder}/tmp-%n
MpiDefault=pmix
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
ReturnToService=2
SlurmdParameters=config_overrides
${names.map((name, i) => `NodeName=${name} NodeAddr=${addresses[i]} CPUs=4 State=UNKNOWN`).join('\n')}
PartitionName=all Nodes=${names.join(',')} Default=YES State=UP MaxTime=INFINITE OverSubscribe=NO
`;
}

export class Slurm {
  #hosts;
  #daemons = [];
  #env;

  /** Returns when all nodes take jobs. */
  static async start(hosts) {
    const slurm = new Slurm();
    await slurm.#begin(hosts, inScratch('slurm'));
    return slurm;
  }

  async #begin(hosts, folder) {
    this.#hosts = hosts;
    // A TmpFS for each node, there before it is: else the PMIx of one node meets that of another, and hangs.
    for (const name of ['', '/state', ...hosts.names.flatMap((host) => [`/spool-${host}`, `/tmp-${host}`])])
      mkdirSync(folder + name, { recursive: true, mode: 0o755 });
    writeFileSync(`${folder}/munge.key`, randomBytes(128), { mode: 0o400 });
    writeFileSync(`${folder}/slurm.conf`, configuration(folder, hosts));
    this.#env = { SLURM_CONF: `${folder}/slurm.conf`, PATH: `${process.env.PATH}:/usr/sbin` };
    // Forced: it runs as root here, in a folder that others may read.
    this.#daemon(0, 'munged', '--foreground', '--force', ...['socket', 'key-file', 'log-file', 'pid-file', 'seed-file']
      .map((option) => `--${option}=${folder}/munge.${option.split('-')[0]}`));
    await this.#until('munge', ['-s', 'x', '-S', `${folder}/munge.socket`], () => true);
    this.#daemon(0, 'slurmctld', '-D');
    hosts.names.forEach((name, i) => this.#daemon(i, 'slurmd', '-D', '-N', name));
    await this.#until('sinfo', ['--noheader', '-o', '%t %D'], (text) => text.trim() === `idle ${hosts.names.length}`);
  }

  #daemon(host, command, ...args) {
    this.#daemons.push(this.#hosts.start(host, command, args, { env: this.#env, seconds: kDeadline }));
  }

  async #until(command, args, good) {
    for (let i = 0; i < 200; ++i) {
      const { status, stdout } = await this.start(command, args).ended;
      if (status === 0 && good(stdout)) return;
      const dead = this.#daemons.find(({ child }) => child.exitCode !== null);
      if (dead) throw new Error(`${dead.line} ended: ${dead.stderr}`);
      await new Promise((resolve) => setTimeout(resolve, 100));
    }
    throw new Error(`no answer of ${command} ${args.join(' ')}\n${this.#daemons.map(({ line, stderr }) => `${line}: ${stderr}`).join('\n')}`);
  }

  /** One of Slurm's commands, on the first host. */
  start(command, args, options = {}) {
    return this.#hosts.start(0, command, args, { ...options, env: { ...this.#env, ...options.env } });
  }

  async close() {
    for (const daemon of this.#daemons.reverse()) daemon.signal('SIGTERM');
    await Promise.all(this.#daemons.map(({ ended }) => ended));
  }
}
