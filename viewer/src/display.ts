// SPDX-License-Identifier: Apache-2.0
// How the session displays its pictures, which is no part of the scene: what reconstructs pixels from
// samples, how much of a moving picture is cast anew, and whether it rocks at rest.

import * as decode from './decode';

export type Filter = 'box' | 'bilinear' | 'biquadratic' | 'piecewise-quadratic' | 'bicubic';
/** Per cent of the samples that are cast anew for each picture while it moves. */
export type Update = '100' | '50' | '25' | 'frameless';

export interface Display {
  readonly filter: Filter;
  readonly update: Update;
  readonly cine: boolean;
}

export const kDefaultDisplay: Display = { filter: 'bilinear', update: '100', cine: false };

export const displayFrom = (at: ReturnType<typeof decode.fields>): Display => ({
  filter: at('filter', decode.oneOf('box', 'bilinear', 'biquadratic', 'piecewise-quadratic', 'bicubic')),
  update: at('update', decode.oneOf('100', '50', '25', 'frameless')),
  cine: at('cine', decode.boolean),
});

export const displayOf: decode.Decoder<Display> = (value, where) => displayFrom(decode.fields(value, where));

const same = (a: Display, b: Display): boolean => a.filter === b.filter && a.update === b.update && a.cine === b.cine;

/** What the controls show: this page's newest choice until the server has answered it, else the server's word. */
export class DisplayChoice {
  private server_ = kDefaultDisplay;
  private shown_ = kDefaultDisplay;
  private unsent_ = false;
  /** Of the newest choice that was sent and is not answered; 0: none. */
  private sent_ = 0;

  get shown(): Display {
    return this.shown_;
  }

  get waiting(): boolean {
    return this.unsent_;
  }

  /** False if that is what is chosen already. */
  choose(change: Partial<Display>): boolean {
    const next = { ...this.shown_, ...change };
    if (same(next, this.shown_)) return false;
    this.shown_ = next;
    this.unsent_ = true;
    return true;
  }

  /** Hands over what is to be sent as input `serial`. */
  take(serial: number): Display {
    this.unsent_ = false;
    this.sent_ = serial;
    return this.shown_;
  }

  /** The server's settings; `own` is the serial of this page's input that made them, 0 for another's. */
  confirm(server: Display, own: number): void {
    this.server_ = server;
    if (own >= this.sent_) this.sent_ = 0;
    this.follow();
  }

  /** The choice did not happen. False if no choice has this serial. */
  refuse(serial: number): boolean {
    if (this.sent_ === 0 || serial !== this.sent_) return false;
    this.sent_ = 0;
    this.follow();
    return true;
  }

  /** Drops what the server has not confirmed. */
  drop(): void {
    this.unsent_ = false;
    this.sent_ = 0;
    this.follow();
  }

  private follow(): void {
    if (!this.unsent_ && this.sent_ === 0) this.shown_ = this.server_;
  }
}
