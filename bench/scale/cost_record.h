// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a view costs where: for each step and block of 16×16 pixels the time of a thread, the bytes
// that go to the compositor, and the error that is left. Recorded once (record.h), then read as the
// same picture with any number of pixels: what a pixel costs stays, there are only more of them.
// Pure.

#include <cstddef>
#include <vector>

#include "common/tile/tile_grid.h"

namespace goldthread::bench {

constexpr int kBlockPixels = 16;  ///< a block's edge; the edges of tiles are multiples of it

/// A step's cost, of a block or of a tile.
struct StepCost {
  double us = 0;
  double bytes = 0;          ///< of samples
  double squared_error = 0;  ///< that is left after it, summed over the pixels
  StepCost& operator+=(const StepCost& other);
};

struct CostRecord {
  int columns = 0;  ///< of blocks
  int rows = 0;
  std::vector<std::vector<StepCost>> steps;  ///< from step 1; in each the blocks row by row
};

/// A view as tiles: steps × tiles of the grid.
struct FrameWork {
  TileGrid grid;
  std::vector<std::vector<StepCost>> steps;
  /// Of all steps of all tiles.
  double us() const;
  double bytes() const;
};

/// The image as it would be with `grid`'s pixels. Each block costs what the recorded block at its
/// place did; sizes need not be multiples.
FrameWork work_of(const CostRecord& image, const TileGrid& grid);

}  // namespace goldthread::bench
