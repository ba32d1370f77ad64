// SPDX-License-Identifier: Apache-2.0
// How good the picture is, in a few words, and how its error fell since the last input.

import { shown } from './dom';
import type { Curve } from './panels/sparkline';
import type { ShownPicture } from './picture-view';
import type { Status } from './protocol';

export type State = 'moving' | 'sharpening' | 'converged' | 'rocking';

const kStates = { moving: 'moving', refining: 'sharpening', converged: 'converged', cine: 'rocking' } as const;

/** What happens to the picture. The picture and this page's own input know it before the next status. */
export function stateOf(picture: ShownPicture | null, status: Status | null, unanswered: number): State | null {
  if (unanswered > 0) return 'moving';
  if (picture && picture.cineFrames > 0) return 'rocking';
  if (picture?.final) return 'converged';
  return status ? kStates[status.phase] : null;
}

/** Two significant digits, and the noughts that keep a falling number from jumping about. */
export const figure = (value: number): string =>
  !Number.isFinite(value) ? '–' : value >= 9.95 ? value.toFixed(0) : value >= 0.995 ? value.toFixed(1)
    : value >= 0.0995 ? value.toFixed(2) : shown(value, 2);

/** One line: error of the picture, samples in a pixel, what happens to it. */
export function qualityLine(picture: ShownPicture | null, status: Status | null, unanswered: number): string {
  if (!picture) return '';
  const { estimatedError } = picture;
  return [
    estimatedError === null ? null : `± ${figure(estimatedError)} / 255`,
    status === null ? null : `${figure(status.samplesPerPixel)} samples per pixel`,
    stateOf(picture, status, unanswered),
  ].filter((part) => part !== null).join(' · ');
}

export interface ErrorPoint {
  readonly seconds: number;
  readonly error: number;
}

const kMostPoints = 240;

/** The errors of the pictures that answer one input. They may go on for ever and are thinned out then. */
export class ErrorHistory {
  private points_: ErrorPoint[] = [];
  private input_ = '';
  private begun_ = 0;

  get points(): readonly ErrorPoint[] {
    return this.points_;
  }

  /** A picture of the input that `input` names was shown at `now` milliseconds. */
  add(input: string, error: number | null, now: number): void {
    if (input !== this.input_) {
      this.points_ = [];
      this.input_ = input;
      this.begun_ = now;
    }
    if (error === null || !(error > 0)) return;
    if (this.points_.length >= kMostPoints) this.points_ = this.points_.filter((_, i) => i % 2 === 0);
    this.points_.push({ seconds: (now - this.begun_) / 1000, error });
  }
}

const kFirstSeconds = 0.03;

/** Error against time, both logarithmic, so that a refinement that never ends has room; a rule where the target is. */
export function errorCurve(points: readonly ErrorPoint[], target: number | null): Curve {
  const errors = points.map(({ error }) => error);
  const known = target !== null && target > 0 ? [target] : [];
  const [least, most] = [Math.min(...errors, ...known), Math.max(...errors, ...known)];
  const height = (error: number): number => Math.log(error / least) / (Math.log(most / least) || 1);
  const along = (seconds: number): number => Math.log1p(seconds / kFirstSeconds);
  const length = along(points.at(-1)?.seconds ?? 0) || 1;
  return {
    points: points.map(({ seconds, error }) => [along(seconds) / length, height(error)]),
    ...(known.length > 0 && { rule: height(target!) }),
    top: `${figure(most)} / 255`,
  };
}
