// SPDX-License-Identifier: Apache-2.0
// A gateway without a cluster, for developing the page: it speaks docs/viewer-protocol.md on
// /session, renders a phantom from coarse to fine, rocks it, and refuses a few edits so that refusals
// can be seen. It trusts its page and must not be used as a server.

import type { Server } from 'node:http';
import type { Http2SecureServer } from 'node:http2';
import { WebSocketServer, type WebSocket } from 'ws';
import { orbit, type Camera } from '../src/camera';
import { kDefaultDisplay, type Display } from '../src/display';
import type { Phase, ToGateway } from '../src/protocol';
import type { Watch } from '../src/load/messages';
import { sceneOf, editableOf } from '../src/scene';
import { regionsOf } from './encode';
import { loadOf, tilesOf } from './load';
import { kTarget, refined, type Refined } from './refine';
import { scene, volume } from './scene';

type Json = Record<string, unknown>;

/** RFC 7396. */
function patched(target: unknown, patch: unknown): unknown {
  if (typeof patch !== 'object' || patch === null || Array.isArray(patch)) return patch;
  const base: Json = typeof target === 'object' && target !== null && !Array.isArray(target) ? { ...(target as Json) } : {};
  for (const [key, value] of Object.entries(patch)) {
    if (value === null) delete base[key];
    else base[key] = patched(base[key], value);
  }
  return base;
}

const kCineFrames = 7;
const kCineDegrees = 2;
const kCineSamples = 1 / 4;
const pause = (milliseconds: number): Promise<void> => new Promise((resolve) => setTimeout(resolve, milliseconds));

class MockGateway {
  private pages_ = new Map<number, { socket: WebSocket; unacknowledged: number; watch: Watch }>();
  private numbers_ = 0;
  private driver_ = 0;
  private scene_: typeof scene & Json = structuredClone(scene);
  private epoch_ = 1;
  private picture_ = 0;
  private input_ = { viewer: 0, serial: 0 };
  private display_: Display = kDefaultDisplay;
  private phase_: Phase = 'moving';
  private refined_: Pick<Refined, 'step' | 'samplesPerPixel' | 'error'> = { step: 0, samplesPerPixel: 0, error: -1 };
  private rested_ = 0;

  constructor() {
    void this.render();
    setInterval(() => this.status(), 250).unref();
    setInterval(() => this.tellWatchers(), 250).unref();
  }

  join(socket: WebSocket): void {
    const viewer = ++this.numbers_;
    socket.on('message', (data, binary) => {
      if (binary) return socket.close(1008, 'a page sends no binary messages');
      this.take(viewer, socket, JSON.parse(String(data)) as ToGateway);
    });
    socket.on('close', () => {
      this.pages_.delete(viewer);
      if (this.driver_ === viewer) this.driver_ = [...this.pages_.keys()][0] ?? 0;
      this.all({ type: 'driver', driver: this.driver_, viewers: this.pages_.size });
    });
  }

  private take(viewer: number, socket: WebSocket, message: ToGateway): void {
    if (message.type === 'hello') return void this.hello(viewer, socket);
    if (message.type === 'ping') return socket.send(JSON.stringify({ type: 'pong', time: message.time }));
    if (message.type === 'ack') {
      const page = this.pages_.get(viewer);
      if (page) page.unacknowledged = 0;
      return;
    }
    if (message.type === 'watch') {
      const page = this.pages_.get(viewer);
      if (page) page.watch = { load: message.load, tiles: message.tiles };
      return;
    }
    if (message.type === 'drive') {
      this.driver_ = viewer;
      return this.all({ type: 'driver', driver: viewer, viewers: this.pages_.size });
    }
    if (viewer !== this.driver_) return;
    if (message.type === 'camera') this.view({ camera: message.camera });
    if (message.type === 'size') this.view({ width: message.width, height: message.height });
    if (message.type === 'edit' && !this.edited(viewer, socket, message)) return;
    this.input_ = { viewer, serial: message.serial };
    if (message.type === 'display') this.displayed(message);
    ++this.epoch_;
  }

  private async hello(viewer: number, socket: WebSocket): Promise<void> {
    for (let done = 0; done <= 4 && this.numbers_ === 1; ++done) {
      socket.send(JSON.stringify({ type: 'loading', what: 'phantom.nii.gz', done: done * 16e6, total: 64e6 }));
      await pause(150);
    }
    this.pages_.set(viewer, { socket, unacknowledged: 0, watch: { load: false, tiles: false } });
    this.driver_ ||= viewer;
    socket.send(JSON.stringify({
      type: 'welcome', protocol: 2, version: '0.1.0-mock', viewer, driver: this.driver_, viewers: this.pages_.size,
      sizeFixed: false, scene: this.scene_, volume,
      display: this.display_,
    }));
    this.all({ type: 'driver', driver: this.driver_, viewers: this.pages_.size });
    ++this.epoch_;
  }

  private displayed({ filter, update, cine }: Display): void {
    this.display_ = { filter, update, cine };
    this.all({ type: 'display', ...this.display_, ...this.input_ });
  }

  private view(change: { camera?: Camera; width?: number; height?: number }): void {
    const { camera, ...size } = change;
    if (camera) this.scene_.camera = camera as unknown as typeof scene.camera;
    this.scene_.image = { ...this.scene_.image, ...size };
    const { width, height } = this.scene_.image;
    this.all({ type: 'view', camera: this.scene_.camera, width, height });
  }

  private edited(viewer: number, socket: WebSocket, message: Extract<ToGateway, { type: 'edit' }>): boolean {
    const { edit, serial } = message;
    const next = structuredClone(this.scene_);
    if (edit.volume) next.volumes[0] = patched(next.volumes[0], edit.volume) as (typeof scene.volumes)[0];
    if (edit.lights) next.lights = edit.lights as unknown as typeof scene.lights;
    if (edit.background) next.image.background = [...edit.background];
    if (edit.step !== undefined) next.step = edit.step;
    try {
      const { volume: look } = editableOf({ ...next, volume: next.volumes[0] }, 'scene');
      if (!(look.transferFunction.unitDistance > 0)) throw new Error('unitDistance must be greater than 0');
      if (next.step > 100) throw new Error('a step of more than 100 mm skips the whole volume');
    } catch (error) {
      const what = (error as Error).message;
      socket.send(JSON.stringify({ type: 'refused', serial, where: 'edit', what, mend: 'choose another value' }));
      return false;
    }
    this.scene_ = next;
    this.all({ type: 'scene', scene: next, viewer, serial });
    return true;
  }

  private all(message: Json): void {
    for (const { socket } of this.pages_.values()) socket.send(JSON.stringify(message));
  }

  /** Coarse to fine, then rocking; a new epoch starts at the coarse end again. */
  private async render(): Promise<void> {
    for (let shown = 0; ; await pause(5)) {
      if (shown === this.epoch_ || this.pages_.size === 0) continue;
      shown = this.epoch_;
      await this.refine(shown);
      if (shown === this.epoch_ && this.display_.cine) await this.rock(shown);
    }
  }

  private async refine(epoch: number): Promise<void> {
    const { camera, editable, width, height } = sceneOf(this.scene_, 'scene');
    this.phase_ = 'moving';
    for (const next of refined(camera, editable, width, height)) {
      // The first picture is shown even if it is overtaken: a drag would show nothing else.
      if (await this.givesWay() && epoch !== this.epoch_ && this.phase_ !== 'moving') return;
      if (!next) continue;
      this.refined_ = next;
      const final = next.error < kTarget;
      this.publish(epoch, next, { lossless: next.samplesPerPixel >= 1, final });
      this.phase_ = final ? 'converged' : 'refining';
      if (final || epoch !== this.epoch_) return;
    }
  }

  private async rock(epoch: number): Promise<void> {
    const { camera, editable, width, height } = sceneOf(this.scene_, 'scene');
    this.phase_ = 'cine';
    for (let frame = 1; frame <= kCineFrames; ++frame) {
      const turned = orbit(camera, kCineDegrees * (frame - (kCineFrames + 1) / 2), 0);
      for (const next of refined(turned, editable, width, height)) {
        await this.givesWay();
        if (epoch !== this.epoch_) return;
        if (!next || next.samplesPerPixel < kCineSamples) continue;
        while ([...this.pages_.values()].some(({ unacknowledged }) => unacknowledged >= 2)) await pause(5);
        this.publish(epoch, next, { cineFrame: frame, cineFrames: kCineFrames });
        break;
      }
    }
  }

  /** Lets others have their turn now and then; true if it did. */
  private async givesWay(): Promise<boolean> {
    if (performance.now() - this.rested_ < 8) return false;
    await new Promise((resolve) => setImmediate(resolve));
    this.rested_ = performance.now();
    return true;
  }

  private publish(epoch: number, { rgb, width, height, error }: Refined,
    kind: { lossless?: boolean; final?: boolean; cineFrame?: number; cineFrames?: number }): void {
    const regions = regionsOf(rgb, { picture: ++this.picture_, epoch, ...this.input_, width, height, error,
      lossless: false, final: false, cineFrame: 0, cineFrames: 0, ...kind });
    for (const page of this.pages_.values()) {
      if (page.unacknowledged >= 2) continue;
      ++page.unacknowledged;
      for (const region of regions) page.socket.send(region);
    }
  }

  /** Only what a page watches is made up. */
  private tellWatchers(): void {
    const now = performance.now();
    const { width, height } = this.scene_.image;
    for (const { socket, watch } of this.pages_.values()) {
      if (watch.load) socket.send(JSON.stringify(loadOf(now, this.phase_ === 'moving')));
      if (watch.tiles) socket.send(JSON.stringify(tilesOf(this.epoch_, width, height)));
    }
  }

  private status(): void {
    const { step, samplesPerPixel, error } = this.refined_;
    const busy = this.phase_ === 'converged' ? 0.05 : 0.9;
    const rank = (rank: number, role: string, share: number, state = 'busy') =>
      ({ rank, role, host: `node${rank >> 1}`, state, busy: busy * share, tiles: rank * 7 });
    this.all({
      type: 'status', epoch: this.epoch_, step, samplesPerPixel, target: kTarget,
      converged: error > 0 ? Math.min(kTarget / error, 1) : 0, estimatedError: error > 0 ? error : null,
      spatialError: Math.sqrt(1 / Math.max(samplesPerPixel, 1e-3)), temporalError: this.phase_ === 'moving' ? 3.2 : 0,
      phase: this.phase_, framesPerSecond: 9.5, rays: 262144 * samplesPerPixel, seconds: 0.42,
      features: ['shading', 'headlight'], kernel: 'AVX2',
      ranks: [rank(0, 'master', 0.2), rank(1, 'compositor', 0.4), rank(2, 'worker', 1), rank(3, 'worker', 0.93),
        rank(4, 'worker', 0, 'lost'), rank(5, 'worker', 0.97)],
    });
  }
}

/** Serves /session on the development server. */
export function attachMock(server: Server | Http2SecureServer): void {
  const gateway = new MockGateway();
  const sockets = new WebSocketServer({ noServer: true });
  server.on('upgrade', (request, socket, head) => {
    if (!request.url?.startsWith('/session')) return;
    sockets.handleUpgrade(request, socket, head, (page) => gateway.join(page));
  });
}
