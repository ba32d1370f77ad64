// SPDX-License-Identifier: Apache-2.0
// Lays the canvas into the stage: as large as fits, its shape kept, and on whole device pixels when
// it can be shown one to one, so that a picture made for this window is not resampled.

/** CSS size of an image of `width` × `height` pixels in a stage of CSS pixels. */
export function layout(width: number, height: number, stageWidth: number, stageHeight: number, pixelRatio: number):
  { left: number; top: number; width: number; height: number } {
  const fit = Math.min(stageWidth / width, stageHeight / height);
  const native = 1 / pixelRatio;
  const scale = Math.abs(fit - native) * Math.max(width, height) < 2 * native ? native : fit;
  const snapped = (css: number): number => Math.round(css * pixelRatio) / pixelRatio;
  return {
    left: snapped((stageWidth - width * scale) / 2), top: snapped((stageHeight - height * scale) / 2),
    width: width * scale, height: height * scale,
  };
}

/** `placed` is called whenever the canvas was laid out. */
export function keepLaidOut(canvas: HTMLCanvasElement, stage: HTMLElement, placed: () => void): () => void {
  const place = (): void => {
    const box = layout(canvas.width, canvas.height, Math.max(stage.clientWidth, 1), Math.max(stage.clientHeight, 1), devicePixelRatio || 1);
    for (const [key, value] of Object.entries(box)) canvas.style.setProperty(key, `${value}px`);
    placed();
  };
  new ResizeObserver(place).observe(stage);
  return place;
}
