// SPDX-License-Identifier: Apache-2.0
// Undo and redo over whole states. Changes of one control within a short time are one step.

const kOneGestureMs = 700;
const kDepth = 200;

export class History<T> {
  private past_: T[] = [];
  private future_: T[] = [];
  private lastKey_ = '';
  private lastTime_ = -Infinity;

  constructor(private readonly same_: (a: T, b: T) => boolean) {}

  /** `before` is the state that `key` is about to change at `now` milliseconds. */
  record(before: T, key: string, now: number): void {
    const goesOn = key === this.lastKey_ && now - this.lastTime_ < kOneGestureMs;
    this.lastKey_ = key;
    this.lastTime_ = now;
    this.future_ = [];
    if (goesOn) return;
    this.past_.push(before);
    if (this.past_.length > kDepth) this.past_.shift();
  }

  /** The state before the last step that still makes a difference, or null. */
  undo(current: T): T | null {
    return this.step(this.past_, this.future_, current);
  }

  redo(current: T): T | null {
    return this.step(this.future_, this.past_, current);
  }

  get canUndo(): boolean {
    return this.past_.length > 0;
  }

  get canRedo(): boolean {
    return this.future_.length > 0;
  }

  clear(): void {
    this.past_ = [];
    this.future_ = [];
    this.lastKey_ = '';
  }

  private step(from: T[], to: T[], current: T): T | null {
    this.lastKey_ = '';
    let state = from.pop();
    while (state !== undefined && this.same_(state, current)) state = from.pop();
    if (state === undefined) return null;
    to.push(current);
    return state;
  }
}
