// SPDX-License-Identifier: Apache-2.0
// The canvas. Its backing store has exactly the image's pixels, and CSS alone scales it; a lossless
// picture at rest is in it bit for bit. A picture is drawn at once when all of its regions have
// come and are decoded, never an older one after a newer one, and reported after it was drawn.
// Frames of a cine loop are kept, and played as soon as none is missing.

import { CineLoop } from './cine-loop';
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
  readonly final: boolean;
  /** 1 … cineFrames; 0: no frame of a cine loop. */
  readonly cineFrame: number;
  readonly cineFrames: number;
  /** Root mean square in 1/255; null: unknown. */
  readonly estimatedError: number | null;
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
  private loop_ = new CineLoop<Decoded[]>();
  /** The newest picture that is no frame of the loop: older frames are of a loop that is over. */
  private plain_ = -1;
  /** The frame of the loop that is on the canvas; 0: none. */
  private painted_ = 0;

  /** `mayPlay_`: may a loop play now? */
  constructor(private readonly canvas_: HTMLCanvasElement, private readonly mayPlay_: () => boolean) {
    const context = canvas_.getContext('2d', { alpha: false, colorSpace: 'srgb' });
    if (!context) throw new Error('this browser has no 2D canvas');
    this.context_ = context;
  }

  get last(): ShownPicture | null {
    return this.last_;
  }

  get cine(): { playing: boolean; frames: number } {
    return { playing: this.loop_.playing && this.mayPlay_(), frames: this.loop_.frames.length };
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
    this.endLoop();
    this.plain_ = -1;
  }

  pixels(): ImageData {
    return this.context_.getImageData(0, 0, this.canvas_.width, this.canvas_.height);
  }

  private async decode(regions: Region[], generation: number): Promise<void> {
    const { picture } = regions[0]!;
    try {
      const decoded = await Promise.all(regions.map(async (region) => ({ region, pixels: await pixelsOf(region) })));
      if (generation === this.generation_) this.take(decoded);
      else this.release(decoded);
    } catch (error) {
      if (generation !== this.generation_) return;
      this.problem.emit(`picture ${picture}: ${error instanceof Error ? error.message : 'it does not decode'}`);
      this.dropped.emit(picture);
    }
  }

  private take(decoded: Decoded[]): void {
    const { picture, cineFrames } = decoded[0]!.region;
    const overtaken = picture <= Math.max(this.last_?.picture ?? -1, this.next_?.[0]?.region.picture ?? -1);
    const wanted = cineFrames > 0 ? this.keep(decoded, overtaken) : !overtaken;
    if (!wanted) return this.release(decoded);
    if (cineFrames === 0) {
      this.plain_ = picture;
      this.endLoop();
    }
    if (!overtaken) {
      if (this.next_?.[0]?.region.cineFrames === 0) this.release(this.next_);
      this.next_ = decoded;
    }
    this.schedule();
  }

  /** Keeps a frame of the loop, in whichever order frames were decoded. False if its place is taken or its loop over. */
  private keep(decoded: Decoded[], overtaken: boolean): boolean {
    const { picture, cineFrame, cineFrames, imageWidth, imageHeight } = decoded[0]!.region;
    if (picture < this.plain_ || picture < (this.loop_.at(cineFrame)?.[0]?.region.picture ?? -1)) return false;
    const resized = this.loop_.frames.some(([other]) =>
      other!.region.imageWidth !== imageWidth || other!.region.imageHeight !== imageHeight);
    if (resized && overtaken) return false;
    if (resized) this.endLoop();
    for (const replaced of this.loop_.put(cineFrame, cineFrames, decoded)) this.release(replaced);
    return true;
  }

  private endLoop(): void {
    for (const frame of this.loop_.clear()) this.release(frame);
    this.painted_ = 0;
  }

  private schedule(): void {
    if (!this.frame_) this.frame_ = requestAnimationFrame((now) => this.tick(now));
  }

  private tick(now: number): void {
    this.frame_ = 0;
    const next = this.next_;
    this.next_ = null;
    if (next) this.present(next);
    const due = this.loop_.due(now, this.mayPlay_());
    if (due !== null && due !== this.painted_) this.paint(this.loop_.at(due)!);
    if (this.loop_.complete || this.next_) this.schedule();
  }

  private present(decoded: Decoded[]): void {
    const { picture, epoch, viewer, serial, imageWidth, imageHeight, cineFrame, cineFrames, estimatedError } = decoded[0]!.region;
    // A frame that comes again while the loop plays waits for its turn.
    if (cineFrames === 0 || !this.cine.playing) this.paint(decoded);
    if (cineFrames === 0) this.release(decoded);
    this.last_ = {
      picture, epoch, viewer, serial, width: imageWidth, height: imageHeight, cineFrame, cineFrames, estimatedError,
      final: decoded.every(({ region }) => region.final),
    };
    this.shown.emit(this.last_);
  }

  private paint(decoded: Decoded[]): void {
    const { imageWidth, imageHeight, cineFrame } = decoded[0]!.region;
    if (this.canvas_.width !== imageWidth || this.canvas_.height !== imageHeight) {
      this.canvas_.width = imageWidth;
      this.canvas_.height = imageHeight;
    }
    for (const { region: { rect }, pixels } of decoded) {
      if (pixels instanceof ImageData) this.context_.putImageData(pixels, rect.x, rect.y);
      else this.context_.drawImage(pixels, rect.x, rect.y);
    }
    this.painted_ = cineFrame;
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
