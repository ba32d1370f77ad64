// SPDX-License-Identifier: Apache-2.0
// When each rank computed: a lane each, the last seconds from left to right. Tall lanes draw how much
// as height, thin ones as strength. The canvas is made when it is first drawn.

import { el } from '../dom';
import { isWorker, timeText } from './measures';
import type { Load, RankLoad } from './messages';

const kGutter = 26;
const kTallest = 18;
const kThinnest = 2;
const kHeight = 200;
const kGap = 1;
/** Lanes this high or higher have their rank's number and a gap between them. */
const kWordedLane = 9;
export const kSeconds = 6;

/** Where the i-th bin of a rank lies, as parts of the time line: 0 oldest, 1 now. */
export function binPlace(load: Pick<Load, 'bin'>, rank: Pick<RankLoad, 'share' | 'age'>, i: number): [number, number] {
  const end = rank.age + (rank.share.length - 1 - i) * load.bin;
  return [1 - (end + load.bin) / (1000 * kSeconds), 1 - end / (1000 * kSeconds)];
}

export function timeline(): { element: HTMLElement; show: (load: Load) => void } {
  const box = el('div', { class: 'timeline' });
  const caption = el('span', { class: 'caption' });
  const axis = el('div', { class: 'timeline-axis', aria: { hidden: 'true' } }, el('span', {}, `−${kSeconds} s`),
    el('span', {}, `−${kSeconds / 2} s`), el('span', {}, 'now'));
  let canvas: HTMLCanvasElement | null = null;
  return {
    element: el('div', { class: 'timeline-frame' }, box, axis, caption),
    show: (load) => {
      if (!canvas) {
        canvas = el('canvas', { role: 'img', aria: { label: 'When each rank computed in the last seconds' } });
        box.append(canvas);
      }
      draw(canvas, box.clientWidth, load);
      const error = Math.max(0, ...load.ranks.filter(({ lost }) => !lost).map((rank) => rank.error));
      caption.textContent = `When each rank computed, in bins of ${load.bin} ms; clocks agree within ${timeText(error)}`;
    },
  };
}

function draw(canvas: HTMLCanvasElement, width: number, { ranks, bin }: Load): void {
  const room = Math.floor(kHeight / Math.max(ranks.length, 1)) - kGap;
  const tall = room >= kWordedLane;
  const lane = tall ? Math.min(kTallest, room) : Math.max(kThinnest, room);
  const gap = tall ? kGap : 0;
  const height = ranks.length * (lane + gap) + gap;
  const ratio = window.devicePixelRatio || 1;
  const [pixelWidth, pixelHeight] = [Math.max(1, Math.round(width * ratio)), Math.max(1, Math.round(height * ratio))];
  if (canvas.width !== pixelWidth || canvas.height !== pixelHeight) [canvas.width, canvas.height] = [pixelWidth, pixelHeight];
  canvas.style.height = `${height}px`;
  const context = canvas.getContext('2d');
  if (!context || width <= kGutter) return;
  const style = getComputedStyle(canvas);
  const color = (name: string): string => style.getPropertyValue(name).trim();
  const [worker, other, text, rule, bad, track] = ['--gold', '--other', '--muted', '--line', '--bad', '--track'].map(color) as [string, string, string, string, string, string];
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = '10px system-ui, sans-serif';
  context.textBaseline = 'middle';
  context.textAlign = 'right';
  const x = (part: number): number => Math.round((kGutter + Math.max(part, 0) * (width - kGutter)) * ratio) / ratio;
  ranks.forEach((rank, i) => {
    const top = gap + i * (lane + gap);
    if (tall) {
      context.fillStyle = rank.lost ? bad : text;
      context.fillText(String(rank.rank), kGutter - 6, top + lane / 2 + 0.5);
    }
    context.fillStyle = track;
    context.fillRect(kGutter, top, width - kGutter, lane);
    context.fillStyle = isWorker(rank) ? worker : other;
    rank.share.forEach((share, j) => {
      const [from, to] = binPlace({ bin }, rank, j);
      if (share <= 0 || to <= 0 || rank.lost) return;
      const filled = tall ? Math.max(share * lane, 1) : lane;
      context.globalAlpha = tall ? 1 : 0.2 + 0.8 * share;
      context.fillRect(x(from), top + lane - filled, x(to) - x(from), filled);
    });
    context.globalAlpha = 1;
  });
  context.fillStyle = rule;
  for (let second = 1; second < kSeconds; ++second) context.fillRect(x(second / kSeconds), 0, 1, height);
}
