// SPDX-License-Identifier: Apache-2.0
// The opacity nodes over the histogram. Owns the selection; the nodes themselves belong to the
// scene and come back through `show` after every report.

import { numberInput, button } from '../controls';
import { el, set, shown, svg } from '../dom';
import type { VolumeInfo } from '../protocol';
import type { OpacityNode, TransferFunction } from '../scene';
import { beside, domainOf, hexOf, movedOpacity, opacityAt, withOpacity, without } from '../transfer-function';
import { alphaOf, curvePath, histogramPath, valueOf, xOf, yOf, type Plot } from './geometry';
import { NodeHandles } from './node-handles';

const kHeight = 150;
const kMargin = 10;
const kGrid = [0.01, 0.1, 0.25, 0.5, 1];

export class OpacityEditor {
  readonly element: HTMLElement;
  private readonly root_ = svg('svg', { class: 'opacity-plot', height: kHeight, role: 'group', 'aria-label': 'Opacity over data values' });
  private readonly histogram_ = svg('path', { class: 'histogram' });
  private readonly gradient_ = svg('linearGradient', { id: 'opacity-fill', gradientUnits: 'userSpaceOnUse', y1: 0, y2: 0 });
  private readonly area_ = svg('path', { class: 'area', fill: 'url(#opacity-fill)' });
  private readonly curve_ = svg('path', { class: 'curve' });
  private readonly grid_ = svg('g', { class: 'grid' });
  private readonly handles_: NodeHandles;
  private readonly value_ = numberInput('Data value of the selected opacity node', {}, (v) => this.type(v, null));
  private readonly alpha_ = numberInput('Opacity of the selected node', { low: 0, high: 1 }, (a) => this.type(null, a));
  private readonly remove_ = button('−', 'Delete the selected opacity node (Delete key)', () => this.drop(this.selected_));
  private tf_: TransferFunction | null = null;
  private volume_: VolumeInfo | null = null;
  private selected_ = 0;
  private width_ = 300;
  /** Frozen while a node is dragged, so that the axis does not run away under the hand. */
  private domain_: [number, number] = [0, 1];

  constructor(private readonly report_: (nodes: OpacityNode[]) => void) {
    this.handles_ = new NodeHandles(this.root_, () => svg('circle', { r: 6 }), {
      select: (i) => { this.selected_ = i; this.draw(); },
      drag: (i, x, y) => this.report(movedOpacity(this.nodes, i, valueOf(this.plot, x), alphaOf(this.plot, y), this.domain_)),
      nudge: (i, dx, dy) => this.nudge(i, dx, dy),
      remove: (i) => this.drop(i),
      add: (i) => this.addAt(beside(this.nodes, i, this.domain_)),
      open: (i) => this.drop(i),
    });
    this.root_.append(svg('defs', {}, this.gradient_), this.histogram_, this.area_, this.grid_, this.curve_, this.handles_.group);
    this.root_.addEventListener('dblclick', (event) => this.doubleClick(event));
    this.element = el('div', { class: 'opacity-editor' }, this.root_,
      el('div', { class: 'node-entry' }, el('label', {}, 'Value ', this.value_.input), el('label', {}, 'Opacity ', this.alpha_.input),
        this.remove_, button('+', 'Add an opacity node beside the selected one (Insert key, or double-click in the plot)',
          () => this.addAt(beside(this.nodes, this.selected_, this.domain_)))));
    new ResizeObserver(() => this.resize()).observe(this.element);
  }

  show(tf: TransferFunction, volume: VolumeInfo, enabled: boolean): void {
    this.tf_ = tf;
    this.volume_ = volume;
    this.handles_.enabled = enabled;
    if (!this.handles_.dragging) this.domain_ = domainOf(volume.range, tf);
    this.selected_ = Math.min(this.selected_, tf.opacity.length - 1);
    this.draw();
  }

  private get nodes(): readonly OpacityNode[] {
    return this.tf_?.opacity ?? [];
  }

  private get plot(): Plot {
    return { width: this.width_, height: kHeight, margin: kMargin, domain: this.domain_ };
  }

  private report(nodes: OpacityNode[]): void {
    if (this.handles_.enabled) this.report_(nodes);
  }

  private nudge(index: number, dx: number, dy: number): void {
    const [value, alpha] = this.nodes[index]!;
    const span = this.domain_[1] - this.domain_[0];
    this.report(movedOpacity(this.nodes, index, value + (dx * span) / 100, alpha + dy / 100, this.domain_));
  }

  private type(value: number | null, alpha: number | null): void {
    const node = this.nodes[this.selected_];
    if (!node) return;
    const anywhere = [-Infinity, Infinity] as const;
    this.report(movedOpacity(this.nodes, this.selected_, value ?? node[0], alpha ?? node[1], anywhere));
  }

  private drop(index: number): void {
    if (this.nodes.length < 2) return;
    this.report(without(this.nodes, index));
    this.selected_ = Math.max(0, index - 1);
    this.handles_.focus(this.selected_);
  }

  private addAt(value: number, alpha = opacityAt(this.nodes, value)): void {
    const { nodes, index } = withOpacity(this.nodes, value, alpha);
    this.report(nodes);
    this.selected_ = index;
    this.draw();
    this.handles_.focus(index);
  }

  private doubleClick(event: MouseEvent): void {
    if (!this.handles_.enabled) return;
    const box = this.root_.getBoundingClientRect();
    this.addAt(valueOf(this.plot, event.clientX - box.x), alphaOf(this.plot, event.clientY - box.y));
  }

  private resize(): void {
    const width = Math.round(this.element.clientWidth);
    if (width < 60 || width === this.width_) return;
    this.width_ = width;
    this.draw();
  }

  private draw(): void {
    if (!this.tf_ || !this.volume_) return;
    const { plot } = this;
    set(this.root_, { viewBox: `0 0 ${plot.width} ${plot.height}`, width: plot.width });
    set(this.histogram_, { d: histogramPath(plot, this.volume_.histogram, this.volume_.range) });
    this.grid_.replaceChildren(...kGrid.flatMap((alpha) => this.gridLine(alpha)));
    set(this.gradient_, { x1: plot.margin, x2: plot.width - plot.margin });
    this.gradient_.replaceChildren(...gradientStops(this.tf_, this.domain_));
    const curve = curvePath(plot, this.nodes);
    const floor = plot.height - plot.margin;
    set(this.curve_, { d: curve });
    set(this.area_, { d: `${curve}L${plot.width - plot.margin} ${floor}L${plot.margin} ${floor}Z` });
    this.handles_.show(this.nodes.map(([value, alpha], i) => ({
      x: xOf(plot, value), y: yOf(plot, alpha), label: `Opacity node ${i + 1} of ${this.nodes.length}`,
      text: `value ${shown(value)}, opacity ${shown(alpha)}`, fill: 'var(--node)', value, low: this.domain_[0], high: this.domain_[1],
    })), this.selected_);
    const node = this.nodes[this.selected_];
    if (node) {
      this.value_.show(node[0]);
      this.alpha_.show(node[1]);
    }
    this.remove_.disabled = this.nodes.length < 2;
  }

  private gridLine(alpha: number): SVGElement[] {
    const y = yOf(this.plot, alpha);
    const label = svg('text', { x: kMargin + 4, y: y + (alpha === 1 ? 10 : -2) });
    label.textContent = String(alpha);
    return [svg('line', { x1: kMargin, x2: this.width_ - kMargin, y1: y, y2: y }), label];
  }
}

/** Stops of a gradient over the domain with the transfer function's colours. */
export function gradientStops(tf: TransferFunction, domain: readonly [number, number]): SVGStopElement[] {
  const at = (value: number): number => (value - domain[0]) / (domain[1] - domain[0]);
  return tf.color.map(([value, r, g, b]) => svg('stop', { offset: at(value).toFixed(5), 'stop-color': hexOf([r, g, b]) }));
}
