// SPDX-License-Identifier: Apache-2.0
// What the controls show: the server's scene with this page's own edits on top until the server has
// answered them. The server's word always wins; a refused edit vanishes and names its control.

import { applied, merged, type Edit, type Editable } from './scene';

interface Sent {
  readonly serial: number;
  readonly edit: Edit;
  readonly control: string;
}

export class Edits {
  private sent_: Sent[] = [];
  private unsent_: Edit | null = null;
  private unsentControl_ = '';
  private shown_: Editable;

  constructor(private server_: Editable) {
    this.shown_ = server_;
  }

  get shown(): Editable {
    return this.shown_;
  }

  get waiting(): boolean {
    return this.unsent_ !== null;
  }

  /** An edit by the control of that name; shown at once. */
  edit(edit: Edit, control: string): void {
    this.unsent_ = this.unsent_ ? merged(this.unsent_, edit) : edit;
    this.unsentControl_ = control;
    this.refresh();
  }

  /** Hands over what is to be sent as input `serial`. */
  take(serial: number): Edit | null {
    const edit = this.unsent_;
    if (edit) this.sent_.push({ serial, edit, control: this.unsentControl_ });
    this.unsent_ = null;
    return edit;
  }

  /** The server's scene; `own` is the serial of this page's input that made it, 0 for another's. */
  confirm(server: Editable, own: number): void {
    this.server_ = server;
    this.sent_ = this.sent_.filter((sent) => sent.serial > own);
    this.refresh();
  }

  /** The edit did not happen. Returns the control that made it. */
  refuse(serial: number): string | null {
    const refused = this.sent_.find((sent) => sent.serial === serial);
    this.sent_ = this.sent_.filter((sent) => sent.serial !== serial);
    this.refresh();
    return refused?.control ?? null;
  }

  /** Drops everything that the server has not confirmed. */
  drop(): void {
    this.sent_ = [];
    this.unsent_ = null;
    this.refresh();
  }

  private refresh(): void {
    const sent = this.sent_.reduce((state, { edit }) => applied(state, edit), this.server_);
    this.shown_ = this.unsent_ ? applied(sent, this.unsent_) : sent;
  }
}
