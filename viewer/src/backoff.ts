// SPDX-License-Identifier: Apache-2.0
// How long to wait before the next attempt to connect: doubling from half a second to ten, spread
// by up to a quarter so that many pages do not come back in one instant.

const kFirstMs = 500;
const kLongestMs = 10000;

/** Milliseconds before attempt number `attempt` (from 1); `random` in [0, 1). */
export function backoff(attempt: number, random: number): number {
  const base = Math.min(kFirstMs * 2 ** Math.max(0, Math.min(attempt, 30) - 1), kLongestMs);
  return base * (0.75 + 0.25 * random);
}
