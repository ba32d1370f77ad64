// SPDX-License-Identifier: Apache-2.0
// Figures of the load: how uneven the work is, and numbers for people.

import type { RankLoad } from './messages';

/** Over which time work is counted. */
export type Span = 'second' | 'view';

/** What a rank worked in a span; null if that is not known of it. */
export const workOf = (rank: RankLoad, span: Span): number | null => (span === 'second' ? rank.busy : rank.view);

export const isWorker = (rank: RankLoad): boolean => rank.role === 'worker';

/** How much longer the busiest worker works than the mean, max/mean − 1; null while none does. */
export function imbalance(ranks: readonly RankLoad[], span: Span): { excess: number; busiest: number } | null {
  const workers = ranks.filter((rank) => isWorker(rank) && !rank.lost && workOf(rank, span) !== null);
  const sum = workers.reduce((total, rank) => total + workOf(rank, span)!, 0);
  if (!(sum > 0)) return null;
  const busiest = workers.reduce((most, rank) => (workOf(rank, span)! > workOf(most, span)! ? rank : most));
  return { excess: (workOf(busiest, span)! * workers.length) / sum - 1, busiest: busiest.rank };
}

/** Bytes in decimal units with three digits: "1.23 MB". */
export function bytesText(bytes: number): string {
  const units = ['B', 'kB', 'MB', 'GB', 'TB'];
  let value = bytes, unit = 0;
  while (value >= 999.5 && unit < units.length - 1) {
    value /= 1000;
    ++unit;
  }
  return `${unit === 0 ? Math.round(value) : digits3(value)} ${units[unit]}`;
}

const digits3 = (value: number): string => value.toFixed(value < 9.995 ? 2 : value < 99.95 ? 1 : 0);

/** A time with three digits: "1.23 ms", "45 µs". */
export function timeText(milliseconds: number): string {
  if (milliseconds >= 999.5) return `${digits3(milliseconds / 1000)} s`;
  return milliseconds >= 0.9995 ? `${digits3(milliseconds)} ms` : `${Math.round(1000 * milliseconds)} µs`;
}
