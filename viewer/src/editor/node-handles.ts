// SPDX-License-Identifier: Apache-2.0
// The handles of the editor's nodes: SVG shapes that are dragged, focused and moved by arrow keys.
// Handles are kept between redraws, so that a drag and the keyboard's focus survive every change.

import { set, svg } from '../dom';

export interface Handle {
  readonly x: number;
  readonly y: number;
  readonly label: string;
  readonly text: string;
  readonly fill: string;
  readonly value: number;
  readonly low: number;
  readonly high: number;
}

export interface HandleEvents {
  select(index: number): void;
  /** Dragged to this place of the plot. */
  drag(index: number, x: number, y: number): void;
  /** Moved by keys: steps of a hundredth of the axis. */
  nudge(index: number, dx: number, dy: number): void;
  remove(index: number): void;
  /** A new node beside this one. */
  add(index: number): void;
  /** Enter or a second press on the node. */
  open(index: number): void;
}

export class NodeHandles {
  readonly group = svg('g');
  private shapes_: SVGGElement[] = [];
  private drags_ = 0;
  enabled = true;

  constructor(private readonly root_: SVGSVGElement, private readonly shape_: () => SVGElement,
    private readonly events_: HandleEvents) {}

  show(handles: readonly Handle[], selected: number): void {
    while (this.shapes_.length < handles.length) this.grow();
    while (this.shapes_.length > handles.length) this.shapes_.pop()!.remove();
    handles.forEach((handle, i) => {
      set(this.shapes_[i]!, {
        transform: `translate(${handle.x.toFixed(1)} ${handle.y.toFixed(1)})`, fill: handle.fill,
        class: i === selected ? 'node selected' : 'node', 'aria-label': handle.label, 'aria-valuetext': handle.text,
        'aria-valuenow': handle.value, 'aria-valuemin': handle.low, 'aria-valuemax': handle.high,
        'aria-disabled': String(!this.enabled), tabindex: 0,
      });
    });
  }

  /** A node is under the hand. */
  get dragging(): boolean {
    return this.drags_ > 0;
  }

  focus(index: number): void {
    this.shapes_[index]?.focus();
  }

  private grow(): void {
    const shape = svg('g', { role: 'slider' }, svg('circle', { r: 14, class: 'touch' }), this.shape_());
    this.shapes_.push(shape);
    this.group.append(shape);
    const index = (): number => this.shapes_.indexOf(shape);
    shape.addEventListener('focus', () => this.events_.select(index()));
    shape.addEventListener('pointerdown', (event) => this.press(event, shape));
    shape.addEventListener('pointermove', (event) => {
      if (!shape.hasPointerCapture(event.pointerId) || !this.enabled) return;
      const box = this.root_.getBoundingClientRect();
      this.events_.drag(index(), event.clientX - box.x, event.clientY - box.y);
    });
    shape.addEventListener('gotpointercapture', () => { ++this.drags_; });
    shape.addEventListener('lostpointercapture', () => { this.drags_ = Math.max(0, this.drags_ - 1); });
    shape.addEventListener('dblclick', (event) => {
      event.stopPropagation();
      if (this.enabled) this.events_.open(index());
    });
    shape.addEventListener('keydown', (event) => this.key(event, index()));
  }

  private press(event: PointerEvent, shape: SVGGElement): void {
    if (event.button !== 0) return;
    event.preventDefault();
    shape.setPointerCapture(event.pointerId);
    shape.focus({ preventScroll: true });
  }

  private key(event: KeyboardEvent, index: number): void {
    if (event.ctrlKey || event.metaKey || event.altKey || !this.enabled) return;
    const size = event.shiftKey ? 0.1 : 1;
    const moves: Record<string, [number, number]> = {
      ArrowLeft: [-size, 0], ArrowRight: [size, 0], ArrowUp: [0, size], ArrowDown: [0, -size],
    };
    const move = moves[event.key];
    if (move) this.events_.nudge(index, ...move);
    else if (event.key === 'Delete' || event.key === 'Backspace') this.events_.remove(index);
    else if (event.key === 'Insert' || event.key === 'a') this.events_.add(index);
    else if (event.key === 'Enter' || event.key === ' ') this.events_.open(index);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}
