// SPDX-License-Identifier: Apache-2.0
// Gathers the regions of pictures. A picture comes out once, when all of its regions have come; a
// newer one drops what is incomplete of an older one, and an older one never follows a newer.
// Whether regions overlap or leave gaps is the gateway's business: they are drawn in index order.

import { failure, success, type Result } from './result';
import type { Region } from './region';

export class PictureAssembler {
  private regions_: (Region | undefined)[] = [];
  private newest_ = -1;

  /** Takes a region in: the complete picture in index order if this was its last one, else null. */
  push(region: Region): Result<Region[] | null> {
    if (region.picture < this.newest_) return success(null);
    if (region.picture > this.newest_) {
      this.newest_ = region.picture;
      this.regions_ = new Array<Region | undefined>(region.count).fill(undefined);
    } else if (this.regions_.length === 0) {
      return failure(`picture ${region.picture} came twice`);
    }
    const other = this.regions_.find((have) => have !== undefined);
    if (this.regions_.length !== region.count || (other && !sameImage(other, region))) {
      return failure(`the regions of picture ${region.picture} contradict each other`);
    }
    if (this.regions_[region.index]) return failure(`region ${region.index} of picture ${region.picture} came twice`);
    this.regions_[region.index] = region;
    if (this.regions_.some((have) => have === undefined)) return success(null);
    const complete = this.regions_ as Region[];
    this.regions_ = [];
    return success(complete);
  }

  /** Forgets everything: a new connection numbers its pictures anew. */
  reset(): void {
    this.regions_ = [];
    this.newest_ = -1;
  }
}

function sameImage(a: Region, b: Region): boolean {
  return a.imageWidth === b.imageWidth && a.imageHeight === b.imageHeight && a.epoch === b.epoch;
}
