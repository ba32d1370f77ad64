// SPDX-License-Identifier: Apache-2.0
// Times of the recent past: how long inputs took to become pictures, and pictures per second.

const kKept = 120;

export class Latencies {
  private values_: number[] = [];

  add(milliseconds: number): void {
    if (!Number.isFinite(milliseconds) || milliseconds < 0) return;
    this.values_.push(milliseconds);
    if (this.values_.length > kKept) this.values_.shift();
  }

  get recent(): readonly number[] {
    return this.values_;
  }

  /** The nearest-rank quantile, or null before the first value. */
  quantile(p: number): number | null {
    if (this.values_.length === 0) return null;
    const sorted = [...this.values_].sort((a, b) => a - b);
    const rank = Math.max(1, Math.ceil(Math.min(Math.max(p, 0), 1) * sorted.length));
    return sorted[rank - 1]!;
  }
}

/** Events per second over the last `span` milliseconds. */
export class Rate {
  private times_: number[] = [];

  constructor(private readonly span_ = 1000) {}

  mark(now: number): void {
    this.times_.push(now);
    this.trim(now);
  }

  perSecond(now: number): number {
    this.trim(now);
    return (this.times_.length * 1000) / this.span_;
  }

  private trim(now: number): void {
    while (this.times_.length > 0 && this.times_[0]! <= now - this.span_) this.times_.shift();
  }
}
