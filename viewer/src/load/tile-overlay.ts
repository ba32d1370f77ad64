// SPDX-License-Identifier: Apache-2.0
// Tiles drawn over the picture: who cast them, or what they cost. A canvas of its own that lies
// exactly on the picture's and exists while it is wanted; the picture knows nothing of it.

import { el } from '../dom';
import type { Session } from '../session';
import { Signal } from '../signal';
import { cssOf, viridis, workerColor } from './colors';
import { timeText } from './measures';
import type { Tile, Tiles } from './messages';

export type OverlayMode = 'none' | 'owners' | 'cost';

const kFill = 0.36;
const kMostChips = 12;
const kNumberedTile = 24;

/** Cost of as many pixels as a whole tile has, so that tiles of all sizes compare. */
const densityOf = (tile: Tile, { tile: [width, height] }: Tiles): number =>
  (tile.cost * width * height) / Math.max(1, tile.width * tile.height);

/** The dearest tile's cost per whole tile's pixels, in ms. */
export const dearest = (tiles: Tiles): number => tiles.tiles.reduce((most, tile) => Math.max(most, densityOf(tile, tiles)), 0);

export class TileOverlay {
  readonly changed = new Signal<OverlayMode>();
  readonly legend = el('div', { class: 'tile-legend', hidden: true });
  private mode_: OverlayMode = 'none';
  private canvas_: HTMLCanvasElement | null = null;
  private frame_ = 0;

  constructor(private readonly session_: Session, private readonly picture_: HTMLCanvasElement) {
    session_.changed.listen((topic) => { if (topic === 'tiles') this.schedule(); });
  }

  get mode(): OverlayMode {
    return this.mode_;
  }

  choose(mode: OverlayMode): void {
    if (mode === this.mode_) return;
    this.mode_ = mode;
    this.session_.watch({ tiles: mode !== 'none' });
    if (mode === 'none') {
      this.canvas_?.remove();
      this.canvas_ = null;
      this.legend.hidden = true;
    }
    this.schedule();
    this.changed.emit(mode);
  }

  /** On, or off if it is on. */
  toggle(mode: OverlayMode): void {
    this.choose(this.mode_ === mode ? 'none' : mode);
  }

  /** The picture's canvas has moved. */
  schedule(): void {
    if (this.mode_ !== 'none' && !this.frame_) this.frame_ = requestAnimationFrame(() => this.draw());
  }

  private draw(): void {
    this.frame_ = 0;
    const { tiles } = this.session_;
    if (this.mode_ === 'none' || !tiles || !this.session_.connected) return;
    if (!this.canvas_) {
      this.canvas_ = el('canvas', { class: 'tiles', aria: { hidden: 'true' } });
      this.picture_.after(this.canvas_);
    }
    const canvas = this.canvas_;
    for (const key of ['left', 'top', 'width', 'height'] as const) canvas.style[key] = this.picture_.style[key];
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [this.picture_.clientWidth, this.picture_.clientHeight].map((side) => Math.max(1, Math.round(side * ratio))) as [number, number];
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const context = canvas.getContext('2d');
    if (!context) return;
    context.clearRect(0, 0, width, height);
    const most = dearest(tiles);
    const color = this.mode_ === 'owners' ? (tile: Tile) => this.colorOf(tile.rank)
      : (tile: Tile) => cssOf(viridis(most > 0 ? densityOf(tile, tiles) / most : 0));
    paint(context, tiles, width / tiles.width, height / tiles.height, ratio, color, this.mode_ === 'owners');
    this.showLegend(tiles, most);
  }

  /** Of a worker's rank, here and wherever else it is shown. */
  colorOf(rank: number): string {
    return workerColor(this.session_.workerIndex(rank));
  }

  private showLegend(tiles: Tiles, most: number): void {
    this.legend.hidden = false;
    this.legend.dataset.mode = this.mode_;
    if (this.mode_ === 'cost') {
      const scale = el('span', { class: 'scale' });
      scale.style.background = `linear-gradient(to right, ${Array.from({ length: 11 }, (_, i) => cssOf(viridis(i / 10))).join(', ')})`;
      this.legend.replaceChildren(el('strong', {}, 'Time spent'), el('span', { class: 'scale-row' }, '0', scale, timeText(most)),
        el('span', { class: 'muted' }, `per ${tiles.tile[0]} × ${tiles.tile[1]} pixels`));
      return;
    }
    const owners = [...new Set(tiles.tiles.map(({ rank }) => rank))].sort((a, b) => a - b);
    const chips = owners.slice(0, kMostChips).map((rank) => {
      const chip = el('span', { class: 'chip' }, String(rank));
      chip.style.setProperty('--chip', this.colorOf(rank));
      return chip;
    });
    const more = owners.length > kMostChips ? `and ${owners.length - kMostChips} more` : '';
    this.legend.replaceChildren(el('strong', {}, 'Cast by rank'), el('span', { class: 'chips' }, ...chips, more));
  }
}

function paint(context: CanvasRenderingContext2D, { tiles }: Tiles, scaleX: number, scaleY: number, ratio: number,
  color: (tile: Tile) => string, numbered: boolean): void {
  const line = Math.max(1, Math.round(ratio));
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.font = `${Math.round(11 * ratio)}px system-ui, sans-serif`;
  for (const tile of tiles) {
    const left = Math.round(tile.x * scaleX), top = Math.round(tile.y * scaleY);
    const width = Math.round((tile.x + tile.width) * scaleX) - left, height = Math.round((tile.y + tile.height) * scaleY) - top;
    context.fillStyle = context.strokeStyle = color(tile);
    context.globalAlpha = kFill;
    context.fillRect(left, top, width, height);
    context.globalAlpha = 0.9;
    context.lineWidth = line;
    context.strokeRect(left + line / 2, top + line / 2, width - line, height - line);
    if (numbered && Math.min(width, height) >= kNumberedTile * ratio) {
      context.globalAlpha = 1;
      context.lineWidth = 3 * ratio;
      context.strokeStyle = 'rgb(0 0 0 / 0.75)';
      context.strokeText(String(tile.rank), left + width / 2, top + height / 2);
      context.fillStyle = '#fff';
      context.fillText(String(tile.rank), left + width / 2, top + height / 2);
    }
  }
  context.globalAlpha = 1;
}
