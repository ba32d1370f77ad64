// SPDX-License-Identifier: Apache-2.0
#pragma once
// The samples of one view that a compositor holds: for each tile of its band one array with a place
// for each pixel and for the replicated column and row. What quanta brought comes in any order, for
// a tile may have changed hands: a place keeps what the latest step brought, and a tile counts as
// having taken a step once that one and all before it are there.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "common/protocol/messages.h"
#include "common/tile/sample.h"
#include "common/tile/tile_grid.h"

namespace goldthread {

/// One tile's samples, rows from the top.
class TileSamples {
 public:
  explicit TileSamples(PixelRect rect);
  /// Nothing is there any more.
  void restart();

  const PixelRect& rect() const { return rect_; }
  /// Places in a row, and rows: (multiple of kCoarsestSpacing) + 1.
  int stride() const { return stride_; }
  int rows() const { return rows_; }
  std::span<const Sample> samples() const { return samples_; }
  /// Which step brought each place; 0: none has.
  std::span<const std::uint8_t> known() const { return known_; }
  /// All steps up to this one are there.
  Step step() const { return step_; }

  /// Puts the samples of a quantum in their places. False, and nothing changed, if a place lies
  /// outside the tile, the bytes are not as many as the count says, or the steps make no sense.
  bool place(const Samples& message);

 private:
  void note(Step from, Step to);

  PixelRect rect_;
  int stride_ = 0;
  int rows_ = 0;
  std::vector<Sample> samples_;
  std::vector<std::uint8_t> known_;
  Step step_ = kNoStep;
  std::vector<std::pair<Step, Step>> ahead_;  ///< quanta that came before an earlier one
};

class SampleArray {
 public:
  SampleArray(const TileGrid& grid, Band band);
  /// For another view of the same grid, in the same memory.
  void restart();

  /// False if the tile is not of this band, or TileSamples::place refuses.
  bool place(const Samples& message);
  /// The step that every tile has taken; the last one of all for a band without tiles.
  Step step() const;
  std::span<const TileSamples> tiles() const { return tiles_; }
  const TileGrid& grid() const { return grid_; }
  /// The band's pixels in the image.
  PixelRect rect() const { return rect_; }

 private:
  TileGrid grid_;
  std::uint32_t first_;  ///< of its tiles
  PixelRect rect_;
  std::vector<TileSamples> tiles_;
  std::vector<std::size_t> at_step_;  ///< how many tiles have taken so many steps and no more
  Step least_ = kNoStep;
};

}  // namespace goldthread
