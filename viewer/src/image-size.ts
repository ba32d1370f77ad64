// SPDX-License-Identifier: Apache-2.0
// The image size that fills a window.

const kSmallestEdge = 16;

/** Device pixels of a window of CSS pixels, its longer side at most `most`, its shape kept. */
export function fitted(width: number, height: number, pixelRatio: number, most: number): { width: number; height: number } {
  const ratio = Math.min(pixelRatio > 0 ? pixelRatio : 1, most / Math.max(width, height, 1));
  const edge = (css: number): number => Math.min(Math.max(Math.round(css * ratio), kSmallestEdge), most);
  return { width: edge(width), height: edge(height) };
}
