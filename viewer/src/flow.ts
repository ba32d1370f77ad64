// SPDX-License-Identifier: Apache-2.0
// Numbers this page's inputs and decides when the next may be sent: not while a couple of them are
// unanswered, so that a slow cluster sees the newest input and never a queue of old ones. An input
// that is never answered blocks for a bounded time only.

const kMaxUnanswered = 2;
const kPatienceMs = 1000;

export class Flow {
  private serial_ = 0;
  private open_: { serial: number; input: number; sent: number }[] = [];

  mayFlow(now: number): boolean {
    const newest = this.open_.at(-1);
    return this.open_.length < kMaxUnanswered || now - newest!.sent > kPatienceMs;
  }

  /** The serial of an input that the user made at `input` and that is sent at `now`. */
  next(input: number, now: number): number {
    this.open_.push({ serial: ++this.serial_, input, sent: now });
    if (this.open_.length > 64) this.open_.shift();
    return this.serial_;
  }

  /** A picture with the input `serial` was shown at `now`: the milliseconds that this input took. */
  answered(serial: number, now: number): number | null {
    const match = this.open_.find((entry) => entry.serial === serial);
    this.open_ = this.open_.filter((entry) => entry.serial > serial);
    return match ? now - match.input : null;
  }

  /** The input needs no picture: it was refused, or did what it can do without one. */
  settled(serial: number): void {
    this.open_ = this.open_.filter((entry) => entry.serial !== serial);
  }

  get unanswered(): number {
    return this.open_.length;
  }

  get serial(): number {
    return this.serial_;
  }

  /** This page stopped driving: what is open will never be answered. */
  abandon(): void {
    this.open_ = [];
  }

  /** A new connection: serials start anew. */
  reset(): void {
    this.serial_ = 0;
    this.open_ = [];
  }
}
