// SPDX-License-Identifier: Apache-2.0
// The colour nodes: a bar with the colours as they are interpolated, and a handle for each node.

import { button, colorInput, numberInput } from '../controls';
import { el, set, shown, svg } from '../dom';
import type { VolumeInfo } from '../protocol';
import type { ColorNode, TransferFunction } from '../scene';
import { beside, domainOf, hexOf, movedColor, recolored, withColor, without } from '../transfer-function';
import { valueOf, xOf, type Plot } from './geometry';
import { NodeHandles } from './node-handles';
import { gradientStops } from './opacity-editor';

const kHeight = 44;
const kBar = 18;
const kMargin = 10;

export class ColorEditor {
  readonly element: HTMLElement;
  private readonly root_ = svg('svg', { class: 'color-plot', height: kHeight, role: 'group', 'aria-label': 'Colour over data values' });
  private readonly gradient_ = svg('linearGradient', { id: 'color-fill', gradientUnits: 'userSpaceOnUse', y1: 0, y2: 0 });
  private readonly bar_ = svg('rect', { class: 'bar', x: kMargin, y: 2, height: kBar, rx: 3, fill: 'url(#color-fill)' });
  private readonly handles_: NodeHandles;
  private readonly value_ = numberInput('Data value of the selected colour node', {},
    (value) => this.report(movedColor(this.nodes, this.selected_, value, [-Infinity, Infinity])));
  private readonly color_ = colorInput('Colour of the selected node',
    (rgb) => this.report(recolored(this.nodes, this.selected_, rgb)));
  private readonly remove_ = button('−', 'Delete the selected colour node (Delete key)', () => this.drop(this.selected_));
  private tf_: TransferFunction | null = null;
  private selected_ = 0;
  private width_ = 300;
  /** Frozen while a node is dragged, so that the axis does not run away under the hand. */
  private domain_: [number, number] = [0, 1];

  constructor(private readonly report_: (nodes: ColorNode[]) => void) {
    const shape = (): SVGElement => svg('path', { d: 'M0 -8L7 1V9H-7V1Z' });
    this.handles_ = new NodeHandles(this.root_, shape, {
      select: (i) => { this.selected_ = i; this.draw(); },
      drag: (i, x) => this.report(movedColor(this.nodes, i, valueOf(this.plot, x), this.domain_)),
      nudge: (i, dx) => this.nudge(i, dx),
      remove: (i) => this.drop(i),
      add: (i) => this.addAt(beside(this.nodes, i, this.domain_)),
      open: () => this.color_.element.click(),
    });
    this.root_.append(svg('defs', {}, this.gradient_), this.bar_, this.handles_.group);
    this.root_.addEventListener('dblclick', (event) => {
      if (this.handles_.enabled) this.addAt(valueOf(this.plot, event.clientX - this.root_.getBoundingClientRect().x));
    });
    this.element = el('div', { class: 'color-editor' }, this.root_,
      el('div', { class: 'node-entry' }, el('label', {}, 'Value ', this.value_.input), el('label', {}, 'Colour ', this.color_.element),
        this.remove_, button('+', 'Add a colour node beside the selected one (Insert key, or double-click on the bar)',
          () => this.addAt(beside(this.nodes, this.selected_, this.domain_)))));
    new ResizeObserver(() => this.resize()).observe(this.element);
  }

  show(tf: TransferFunction, volume: VolumeInfo, enabled: boolean): void {
    this.tf_ = tf;
    this.handles_.enabled = enabled;
    if (!this.handles_.dragging) this.domain_ = domainOf(volume.range, tf);
    this.selected_ = Math.min(this.selected_, tf.color.length - 1);
    this.draw();
  }

  private get nodes(): readonly ColorNode[] {
    return this.tf_?.color ?? [];
  }

  private get plot(): Plot {
    return { width: this.width_, height: kHeight, margin: kMargin, domain: this.domain_ };
  }

  private report(nodes: ColorNode[]): void {
    if (this.handles_.enabled) this.report_(nodes);
  }

  private nudge(index: number, dx: number): void {
    const span = this.domain_[1] - this.domain_[0];
    this.report(movedColor(this.nodes, index, this.nodes[index]![0] + (dx * span) / 100, this.domain_));
  }

  private drop(index: number): void {
    if (this.nodes.length < 2) return;
    this.report(without(this.nodes, index));
    this.selected_ = Math.max(0, index - 1);
    this.handles_.focus(this.selected_);
  }

  private addAt(value: number): void {
    const { nodes, index } = withColor(this.nodes, value);
    this.report(nodes);
    this.selected_ = index;
    this.draw();
    this.handles_.focus(index);
  }

  private resize(): void {
    const width = Math.round(this.element.clientWidth);
    if (width < 60 || width === this.width_) return;
    this.width_ = width;
    this.draw();
  }

  private draw(): void {
    if (!this.tf_) return;
    const { plot } = this;
    set(this.root_, { viewBox: `0 0 ${plot.width} ${plot.height}`, width: plot.width });
    set(this.bar_, { width: plot.width - 2 * kMargin });
    set(this.gradient_, { x1: kMargin, x2: plot.width - kMargin });
    this.gradient_.replaceChildren(...gradientStops(this.tf_, this.domain_));
    this.handles_.show(this.nodes.map(([value, r, g, b], i) => ({
      x: xOf(plot, value), y: kBar + 12, label: `Colour node ${i + 1} of ${this.nodes.length}`,
      text: `value ${shown(value)}, colour ${hexOf([r, g, b])}`, fill: hexOf([r, g, b]), value,
      low: this.domain_[0], high: this.domain_[1],
    })), this.selected_);
    const node = this.nodes[this.selected_];
    if (node) {
      this.value_.show(node[0]);
      this.color_.show([node[1], node[2], node[3]]);
    }
    this.remove_.disabled = this.nodes.length < 2;
  }
}
