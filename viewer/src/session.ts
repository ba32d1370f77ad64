// SPDX-License-Identifier: Apache-2.0
// The state of the page: what the gateway said and what the user is doing to it. Everything that
// the panels show is read from here, and every input goes through here; a page that does not drive
// sends none. One pass per animation frame sends at most one camera, one edit, one
// size and one choice of display.

import { framed, type Camera } from './camera';
import type { Connection, ConnectionState } from './connection';
import { DisplayChoice, type Display } from './display';
import { Edits } from './edits';
import { Flow } from './flow';
import { History } from './history';
import { Latencies, Rate } from './latency';
import type { Look } from './link';
import type { Load, Tiles, Watch } from './load/messages';
import type { ShownPicture } from './picture-view';
import type { Failure, FromGateway, Status, VolumeInfo, Welcome } from './protocol';
import { ErrorHistory } from './quality';
import { difference, type Edit, type Editable } from './scene';
import { Signal } from './signal';

export type Topic = 'connection' | 'driver' | 'camera' | 'scene' | 'display' | 'status' | 'load' | 'tiles' | 'picture' | 'refused' | 'notice';

export class Session {
  readonly changed = new Signal<Topic>();

  version = '';
  viewer = 0;
  driver = 0;
  viewers = 0;
  sizeFixed = false;
  loading: { what: string; done: number; total: number } | null = null;
  failed: Failure | null = null;
  status: Status | null = null;
  /** What the server told last of what this page watches. */
  load: Load | null = null;
  tiles: Tiles | null = null;
  volume: VolumeInfo | null = null;
  picture: ShownPicture | null = null;
  camera: Camera | null = null;
  /** The image size that the server last told. */
  size = { width: 0, height: 0 };
  /** The look and camera that this session began with. */
  original: Look | null = null;
  edits: Edits | null = null;
  /** What the server did not accept, and which control asked for it. */
  refusal: (Failure & { control: string }) | null = null;
  notice = '';
  readonly latencies = new Latencies();
  readonly rate = new Rate();
  readonly errors = new ErrorHistory();
  private readonly history_ = new History<Editable>((a, b) => Object.keys(difference(a, b)).length === 0);
  private readonly flow_ = new Flow();
  private readonly display_ = new DisplayChoice();
  private unsentCamera_ = false;
  private movedCamera_ = false;
  private unsentSize_: { width: number; height: number } | null = null;
  /** The size that this page asked for last; what the server tells may still be older. */
  private askedSize_: { width: number; height: number } | null = null;
  private inputTime_ = 0;
  private frame_ = 0;
  private wished_: Watch = { load: false, tiles: false };
  private hidden_ = false;
  private watched_: Watch = { load: false, tiles: false };

  constructor(private readonly connection_: Connection) {
    connection_.message.listen((message) => this.take(message));
    connection_.state.listen((state) => this.connectionChanged(state));
  }

  get connected(): boolean {
    return this.connection_.current === 'open' && this.edits !== null && this.viewer > 0 && !this.failed;
  }

  get drives(): boolean {
    return this.connected && this.driver === this.viewer;
  }

  get editable(): Editable | null {
    return this.edits?.shown ?? null;
  }

  get display(): Display {
    return this.display_.shown;
  }

  /** May a cine loop play? Not while the user does something: that ends it at once. */
  get rocks(): boolean {
    return this.connected && this.display.cine && this.unanswered === 0;
  }

  get canUndo(): boolean {
    return this.drives && this.history_.canUndo;
  }

  get canRedo(): boolean {
    return this.drives && this.history_.canRedo;
  }

  /** Inputs that no picture on the canvas answers yet; those that wait to be sent count as one. */
  get unanswered(): number {
    return this.flow_.unanswered + (this.hasUnsent() ? 1 : 0);
  }

  /** What the server is asked for beside the picture. */
  get watches(): Watch {
    return this.watched_;
  }

  get serial(): number {
    return this.flow_.serial;
  }

  moveCamera(camera: Camera, time = performance.now()): void {
    if (!this.drives) return;
    this.camera = camera;
    this.unsentCamera_ = true;
    this.schedule(time);
    this.changed.emit('camera');
  }

  frameVolume(): void {
    if (this.camera && this.volume) this.moveCamera(framed(this.camera, this.volume.center, this.volume.radius));
  }

  /** Changes the scene; `control` names the control for undo and for the server's refusals. */
  edit(edit: Edit, control: string): void {
    if (!this.drives || !this.edits) return;
    this.history_.record(this.edits.shown, control, performance.now());
    this.applyEdit(edit, control);
  }

  undo(): void {
    this.restore(this.edits && this.history_.undo(this.edits.shown), 'undo');
  }

  redo(): void {
    this.restore(this.edits && this.history_.redo(this.edits.shown), 'redo');
  }

  applyLook(look: Look): void {
    if (!this.drives || !this.edits) return;
    this.moveCamera(look.camera);
    this.edit(difference(this.edits.shown, look.editable), 'link');
  }

  askSize(width: number, height: number): void {
    const newest = this.askedSize_ ?? this.size;
    if (!this.drives || (width === newest.width && height === newest.height)) return;
    this.askedSize_ = this.unsentSize_ = { width, height };
    this.schedule(performance.now());
  }

  choose(change: Partial<Display>): void {
    if (!this.drives || !this.display_.choose(change)) return;
    this.schedule(performance.now());
    this.changed.emit('display');
  }

  takeOver(): void {
    this.connection_.send({ type: 'drive' });
  }

  watch(change: Partial<Watch>): void {
    this.wished_ = { ...this.wished_, ...change };
    this.tellWatch();
  }

  /** Whether nobody can see the page now: it watches nothing then. */
  hide(hidden: boolean): void {
    this.hidden_ = hidden;
    this.tellWatch();
  }

  /** The place of a rank among the workers. */
  workerIndex(rank: number): number {
    const first = this.status?.ranks.find(({ role }) => role === 'worker')?.rank ?? 0;
    return Math.max(0, rank - first);
  }

  say(notice: string): void {
    this.notice = notice;
    this.changed.emit('notice');
  }

  pictureShown(picture: ShownPicture): void {
    const now = performance.now();
    this.picture = picture;
    this.rate.mark(now);
    if (picture.cineFrames === 0) this.errors.add(`${picture.viewer}.${picture.serial}`, picture.estimatedError, now);
    if (picture.viewer === this.viewer && picture.serial > 0) {
      const took = this.flow_.answered(picture.serial, now);
      if (took !== null) this.latencies.add(took);
      if (this.hasUnsent()) this.schedule(this.inputTime_);
    }
    this.connection_.send({ type: 'ack', picture: picture.picture });
    this.changed.emit('picture');
  }

  private tellWatch(): void {
    const { load, tiles } = this.hidden_ ? { load: false, tiles: false } : this.wished_;
    if (!this.connected || (load === this.watched_.load && tiles === this.watched_.tiles)) return;
    if (!load) this.load = null;
    if (!tiles) this.tiles = null;
    this.watched_ = { load, tiles };
    this.connection_.send({ type: 'watch', load, tiles });
  }

  private restore(state: Editable | null, control: string): void {
    if (!this.drives || !this.edits || !state) return;
    this.applyEdit(difference(this.edits.shown, state), control);
  }

  private applyEdit(edit: Edit, control: string): void {
    if (Object.keys(edit).length === 0) return;
    this.edits!.edit(edit, control);
    this.refusal = null;
    this.schedule(performance.now());
    this.changed.emit('scene');
  }

  private hasUnsent(): boolean {
    return this.unsentCamera_ || this.unsentSize_ !== null || this.display_.waiting || (this.edits?.waiting ?? false);
  }

  private schedule(time: number): void {
    if (!this.frame_) {
      this.inputTime_ = time;
      this.frame_ = requestAnimationFrame(() => this.flush());
    }
  }

  private flush(): void {
    this.frame_ = 0;
    if (!this.drives) return this.dropInputs();
    const now = performance.now();
    if (!this.flow_.mayFlow(now)) {
      if (this.hasUnsent()) this.frame_ = requestAnimationFrame(() => this.flush());
      return;
    }
    const next = (): number => this.flow_.next(this.inputTime_, now);
    if (this.unsentSize_) this.connection_.send({ type: 'size', serial: next(), ...this.unsentSize_ });
    this.unsentSize_ = null;
    if (this.display_.waiting) {
      const serial = next();
      this.connection_.send({ type: 'display', serial, ...this.display_.take(serial) });
    }
    if (this.edits?.waiting) {
      const serial = next();
      this.connection_.send({ type: 'edit', serial, edit: this.edits.take(serial)! });
    }
    if (this.unsentCamera_ && this.camera) {
      this.connection_.send({ type: 'camera', serial: next(), camera: this.camera });
      this.movedCamera_ = true;
    }
    this.unsentCamera_ = false;
  }

  private dropInputs(): void {
    this.unsentCamera_ = false;
    this.movedCamera_ = false;
    this.unsentSize_ = null;
    this.askedSize_ = null;
    this.display_.drop();
    this.edits?.drop();
  }

  private connectionChanged(state: ConnectionState): void {
    if (state !== 'open') {
      this.viewer = 0;
      this.loading = null;
      this.status = this.load = this.tiles = null;
      this.watched_ = { load: false, tiles: false };
      this.dropInputs();
    } else {
      this.flow_.reset();
    }
    this.changed.emit('connection');
  }

  private take(message: FromGateway): void {
    switch (message.type) {
      case 'welcome': return this.welcomed(message);
      case 'loading':
        this.loading = message;
        this.failed = null;
        return this.changed.emit('connection');
      case 'driver': return this.driverChanged(message.driver, message.viewers);
      case 'view': return this.viewChanged(message.camera, message.width, message.height);
      case 'scene': {
        const own = message.viewer === this.viewer;
        this.edits?.confirm(message.scene.editable, own ? message.serial : 0);
        if (!own) this.history_.clear();
        return this.changed.emit('scene');
      }
      case 'display': {
        const own = message.viewer === this.viewer ? message.serial : 0;
        this.flow_.settled(own);
        this.display_.confirm(message.display, own);
        return this.changed.emit('display');
      }
      case 'refused': return this.refused(message.serial, message);
      case 'status':
        this.status = message;
        return this.changed.emit('status');
      // What was on its way when the page stopped to watch is dropped.
      case 'load':
        if (!this.watched_.load) return;
        this.load = message.load;
        return this.changed.emit('load');
      case 'tiles':
        if (!this.watched_.tiles) return;
        this.tiles = message.tiles;
        return this.changed.emit('tiles');
      case 'failed':
        this.failed = message;
        this.dropInputs();
        this.changed.emit('connection');
        return this.changed.emit('scene');
      case 'pong': return;
    }
  }

  private refused(serial: number, { where, what, mend }: Failure): void {
    this.flow_.settled(serial);
    this.askedSize_ = this.unsentSize_;
    if (!this.connected) this.failed = { where, what, mend };
    const control = this.display_.refuse(serial) ? 'display' : this.edits?.refuse(serial) ?? '';
    this.refusal = { control, where, what, mend };
    this.changed.emit('scene');
    this.changed.emit('display');
    this.changed.emit(this.connected ? 'refused' : 'connection');
  }

  private welcomed(message: Welcome): void {
    const { scene } = message;
    Object.assign(this, {
      version: message.version, viewer: message.viewer, driver: message.driver, viewers: message.viewers,
      sizeFixed: message.sizeFixed, volume: message.volume, camera: scene.camera, loading: null, failed: null,
      size: { width: scene.width, height: scene.height }, refusal: null,
    });
    this.edits = new Edits(scene.editable);
    this.display_.confirm(message.display, 0);
    this.original ??= { camera: scene.camera, editable: scene.editable };
    this.history_.clear();
    this.movedCamera_ = false;
    this.tellWatch();
    this.changed.emit('connection');
    this.changed.emit('driver');
    this.changed.emit('camera');
    this.changed.emit('scene');
    this.changed.emit('display');
  }

  private driverChanged(driver: number, viewers: number): void {
    const changed = driver !== this.driver;
    this.driver = driver;
    this.viewers = viewers;
    if (changed) {
      this.dropInputs();
      this.flow_.abandon();
      this.changed.emit('scene');
      this.changed.emit('display');
    }
    this.changed.emit('driver');
  }

  /** The driver's own camera is newer than what the server echoes; a watcher follows. */
  private viewChanged(camera: Camera, width: number, height: number): void {
    this.size = { width, height };
    if (!this.drives || (!this.movedCamera_ && !this.unsentCamera_)) this.camera = camera;
    this.changed.emit('camera');
  }
}
