// SPDX-License-Identifier: Apache-2.0
// Turns pointers, wheel and keys on the picture into camera moves. One finger or the left button
// turns, middle or shift-left pans, right or wheel zooms, control-left rolls; two fingers pan, zoom
// and roll at once. Events only change the camera; when it is sent is decided elsewhere.

import { dolly, dragFactor, dragOrbit, orbit, pan, roll, wheelFactor, type Camera } from './camera';

export interface CameraHolder {
  /** The camera to move, or null while this page may not move it. */
  camera(): Camera | null;
  move(camera: Camera, time: number): void;
  /** A length of the scene in millimetres that bounds the zoom. */
  reference(): number;
}

type Gesture = 'orbit' | 'pan' | 'dolly' | 'roll';
type Point = { x: number; y: number };

const kKeyDegrees = 5;
const kWheelNotchPx = 100;
const kLineHeightPx = 16;

function gestureOf(event: PointerEvent): Gesture {
  if (event.button === 1 || (event.button === 0 && event.shiftKey)) return 'pan';
  if (event.button === 2) return 'dolly';
  return event.ctrlKey || event.metaKey ? 'roll' : 'orbit';
}

export class Interactor {
  private pointers_ = new Map<number, Point>();
  private gesture_: Gesture = 'orbit';

  constructor(private readonly canvas_: HTMLElement, private readonly holder_: CameraHolder) {
    canvas_.addEventListener('pointerdown', (event) => this.down(event));
    canvas_.addEventListener('pointermove', (event) => this.moved(event));
    for (const type of ['pointerup', 'pointercancel', 'lostpointercapture'] as const) {
      canvas_.addEventListener(type, (event) => this.up(event));
    }
    canvas_.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    // The middle button would start the browser's own scrolling.
    canvas_.addEventListener('mousedown', (event) => { if (event.button === 1) event.preventDefault(); });
    canvas_.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas_.addEventListener('keydown', (event) => this.key(event));
  }

  private change(move: (camera: Camera) => Camera, time: number): void {
    const camera = this.holder_.camera();
    if (camera) this.holder_.move(move(camera), time);
  }

  private down(event: PointerEvent): void {
    if (this.pointers_.size === 0) this.gesture_ = gestureOf(event);
    this.pointers_.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.canvas_.setPointerCapture(event.pointerId);
    this.canvas_.dataset.gesture = this.gesture_;
  }

  private up(event: PointerEvent): void {
    this.pointers_.delete(event.pointerId);
    if (this.pointers_.size === 0) delete this.canvas_.dataset.gesture;
  }

  private moved(event: PointerEvent): void {
    const from = this.pointers_.get(event.pointerId);
    if (!from) return;
    const to = { x: event.clientX, y: event.clientY };
    const others = [...this.pointers_].filter(([id]) => id !== event.pointerId).map(([, point]) => point);
    this.pointers_.set(event.pointerId, to);
    if (others.length > 1 || (from.x === to.x && from.y === to.y)) return;
    const time = event.timeStamp;
    const height = Math.max(this.canvas_.clientHeight, 1);
    const [dx, dy] = [(to.x - from.x) / height, (to.y - from.y) / height];
    if (others.length === 1) this.change((camera) => this.pinched(camera, others[0]!, from, to, dx, dy), time);
    else this.change((camera) => this.dragged(camera, dx, dy, from, to), time);
  }

  private dragged(camera: Camera, dx: number, dy: number, from: Point, to: Point): Camera {
    switch (this.gesture_) {
      case 'orbit': return dragOrbit(camera, dx, dy);
      case 'pan': return pan(camera, dx, dy);
      case 'dolly': return dolly(camera, dragFactor(dy), this.holder_.reference());
      case 'roll': {
        const box = this.canvas_.getBoundingClientRect();
        const center = { x: box.x + box.width / 2, y: box.y + box.height / 2 };
        return roll(camera, turn(center, from, to));
      }
    }
  }

  /** One of two fingers moved: the picture follows both, each doing its half of the pan. */
  private pinched(camera: Camera, other: Point, from: Point, to: Point, dx: number, dy: number): Camera {
    const span = (point: Point): number => Math.hypot(point.x - other.x, point.y - other.y);
    const factor = span(from) > 8 && span(to) > 8 ? span(to) / span(from) : 1;
    const panned = pan(camera, dx / 2, dy / 2);
    return roll(dolly(panned, factor, this.holder_.reference()), span(from) > 8 ? turn(other, from, to) : 0);
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const unit = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? kLineHeightPx
      : event.deltaMode === WheelEvent.DOM_DELTA_PAGE ? 10 * kLineHeightPx : 1;
    const notches = (-event.deltaY * unit) / kWheelNotchPx;
    this.change((camera) => dolly(camera, wheelFactor(notches), this.holder_.reference()), event.timeStamp);
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const move = this.keyMove(event.key, event.shiftKey);
    if (!move) return;
    event.preventDefault();
    this.change(move, event.timeStamp);
  }

  private keyMove(key: string, shift: boolean): ((camera: Camera) => Camera) | null {
    const arrows: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1],
    };
    const arrow = arrows[key];
    if (arrow) {
      const [x, y] = arrow;
      return (camera) => shift ? pan(camera, 0.03 * x, 0.03 * y) : orbit(camera, -kKeyDegrees * x, kKeyDegrees * y);
    }
    if (key === '+' || key === '=') return (camera) => dolly(camera, wheelFactor(0.5), this.holder_.reference());
    if (key === '-' || key === '_') return (camera) => dolly(camera, wheelFactor(-0.5), this.holder_.reference());
    if (key === '[') return (camera) => roll(camera, -kKeyDegrees);
    if (key === ']') return (camera) => roll(camera, kKeyDegrees);
    return null;
  }
}

/** Degrees clockwise from `from` to `to` as seen from `center`. */
function turn(center: Point, from: Point, to: Point): number {
  const angle = (p: Point): number => (Math.atan2(p.y - center.y, p.x - center.x) * 180) / Math.PI;
  const difference = angle(to) - angle(from);
  return difference > 180 ? difference - 360 : difference < -180 ? difference + 360 : difference;
}
