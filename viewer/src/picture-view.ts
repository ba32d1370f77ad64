// SPDX-License-Identifier: Apache-2.0
// The canvas. Its backing store has exactly the image's pixels, and CSS alone scales it; a lossless
// picture at rest is in it bit for bit. A picture is drawn at once when all of its regions have
// come and are decoded, never an older one after a newer one, and reported after it was drawn.

import { PictureAssembler } from './picture-assembler';
import type { Region } from './region';
import { Signal } from './signal';
import { decodeZstd, rgbaOfRgb } from './zstd-frame';

export interface ShownPicture {
  readonly picture: number;
  readonly epoch: number;
  readonly viewer: number;
  readonly serial: number;
  readonly width: number;
  readonly height: number;
  readonly spacing: number;
  readonly final: boolean;
}

type Decoded = { region: Region; pixels: ImageData | ImageBitmap };

export class PictureView {
  readonly shown = new Signal<ShownPicture>();
  readonly problem = new Signal<string>();
  /** A picture that will not be shown, for it is broken or overtaken; the gateway may forget it. */
  readonly dropped = new Signal<number>();

  private assembler_ = new PictureAssembler();
  private context_: CanvasRenderingContext2D;
  private generation_ = 0;
  private last_: ShownPicture | null = null;
  private next_: Decoded[] | null = null;
  private frame_ = 0;

  constructor(private readonly canvas_: HTMLCanvasElement) {
    const context = canvas_.getContext('2d', { alpha: false, colorSpace: 'srgb' });
    if (!context) throw new Error('this browser has no 2D canvas');
    this.context_ = context;
  }

  get last(): ShownPicture | null {
    return this.last_;
  }

  push(region: Region): void {
    const complete = this.assembler_.push(region);
    if (!complete.ok) this.problem.emit(complete.problem);
    else if (complete.value) void this.decode(complete.value, this.generation_);
  }

  /** A new connection: pictures are numbered anew, the last one stays visible. */
  reset(): void {
    ++this.generation_;
    this.assembler_.reset();
    this.last_ = null;
    this.release(this.next_);
    this.next_ = null;
  }

  pixels(): ImageData {
    return this.context_.getImageData(0, 0, this.canvas_.width, this.canvas_.height);
  }

  private async decode(regions: Region[], generation: number): Promise<void> {
    const { picture } = regions[0]!;
    try {
      const decoded = await Promise.all(regions.map(async (region) => ({ region, pixels: await pixelsOf(region) })));
      if (generation !== this.generation_) return this.release(decoded);
      if (picture <= Math.max(this.last_?.picture ?? -1, this.next_?.[0]?.region.picture ?? -1)) {
        this.release(decoded);
        return;
      }
      this.release(this.next_);
      this.next_ = decoded;
      if (!this.frame_) this.frame_ = requestAnimationFrame(() => this.draw());
    } catch (error) {
      if (generation !== this.generation_) return;
      this.problem.emit(`picture ${picture}: ${error instanceof Error ? error.message : 'it does not decode'}`);
      this.dropped.emit(picture);
    }
  }

  private draw(): void {
    this.frame_ = 0;
    const decoded = this.next_;
    if (!decoded) return;
    this.next_ = null;
    const { picture, epoch, viewer, serial, imageWidth, imageHeight } = decoded[0]!.region;
    if (this.canvas_.width !== imageWidth || this.canvas_.height !== imageHeight) {
      this.canvas_.width = imageWidth;
      this.canvas_.height = imageHeight;
    }
    for (const { region: { rect }, pixels } of decoded) {
      if (pixels instanceof ImageData) this.context_.putImageData(pixels, rect.x, rect.y);
      else this.context_.drawImage(pixels, rect.x, rect.y);
    }
    this.release(decoded);
    this.last_ = {
      picture, epoch, viewer, serial, width: imageWidth, height: imageHeight,
      spacing: Math.max(...decoded.map(({ region }) => region.spacing)),
      final: decoded.every(({ region }) => region.final),
    };
    this.shown.emit(this.last_);
  }

  private release(decoded: Decoded[] | null): void {
    for (const { pixels } of decoded ?? []) if (!(pixels instanceof ImageData)) pixels.close();
  }
}

async function pixelsOf(region: Region): Promise<ImageData | ImageBitmap> {
  const { rect: { width, height }, payload } = region;
  if (region.encoding === 'zstd') {
    const rgb = decodeZstd(payload, width * height * 3);
    if (!rgb.ok) throw new Error(rgb.problem);
    return new ImageData(rgbaOfRgb(rgb.value), width, height);
  }
  const bitmap = await createImageBitmap(new Blob([payload], { type: 'image/jpeg' }), {
    colorSpaceConversion: 'none', premultiplyAlpha: 'none',
  }).catch(() => { throw new Error('a JPEG that does not decode'); });
  if (bitmap.width !== width || bitmap.height !== height) {
    const found = `${bitmap.width} × ${bitmap.height}`;
    bitmap.close();
    throw new Error(`a JPEG of ${found} pixels where ${width} × ${height} are due`);
  }
  return bitmap;
}
