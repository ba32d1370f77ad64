// SPDX-License-Identifier: Apache-2.0
// The cine loop: the frames of a rocking view, kept and played back and forth. Pure: it is told the
// time and says which frame is due. Who owns the frames frees what comes out of here.

const kFrameMs = 1000 / 12;

export class CineLoop<Frame> {
  private frames_: (Frame | undefined)[] = [];
  /** The place on the way there and back, 0 … 2 (count − 1) − 1. */
  private place_ = 0;
  /** When the place was reached; null while the loop does not play. */
  private since_: number | null = null;

  /** Those that have come. */
  get frames(): Frame[] {
    return this.frames_.filter((frame) => frame !== undefined);
  }

  get complete(): boolean {
    return this.frames_.length > 0 && this.frames.length === this.frames_.length;
  }

  get playing(): boolean {
    return this.since_ !== null;
  }

  /** Frame `number`, counted from 1. */
  at(number: number): Frame | undefined {
    return this.frames_[number - 1];
  }

  /** Keeps frame `number` of `count`. Returns the frames that it replaces. */
  put(number: number, count: number, frame: Frame): Frame[] {
    const replaced = count === this.frames_.length ? [] : this.clear();
    if (this.frames_.length === 0) this.frames_ = new Array<Frame | undefined>(count).fill(undefined);
    const before = this.at(number);
    if (before !== undefined) replaced.push(before);
    this.frames_[number - 1] = frame;
    // A loop begins to play with the frame that is on the screen: the one that came last.
    if (!this.playing) this.place_ = number - 1;
    return replaced;
  }

  /** Ends the loop. Returns the frames that it kept. */
  clear(): Frame[] {
    const kept = this.frames;
    this.frames_ = [];
    this.place_ = 0;
    this.since_ = null;
    return kept;
  }

  /** The number of the frame that is due at `now` milliseconds; null while the loop may not play or lacks a frame. */
  due(now: number, may: boolean): number | null {
    if (!may || !this.complete) {
      this.since_ = null;
      return null;
    }
    this.since_ ??= now;
    const count = this.frames_.length;
    const steps = Math.max(0, Math.floor((now - this.since_) / kFrameMs));
    this.since_ += steps * kFrameMs;
    this.place_ = (this.place_ + steps) % Math.max(2 * (count - 1), 1);
    return this.place_ < count ? this.place_ + 1 : 2 * count - 1 - this.place_;
  }
}
