// SPDX-License-Identifier: Apache-2.0
#pragma once
// The samples of one view that a compositor holds: for each tile of its band one array with a place
// for each pixel and for the replicated column and row. Samples of any level come in any order; a
// tile counts as being at a level once that one and all coarser ones are there.

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "common/tile/sample.h"
#include "common/tile/tile_grid.h"

namespace goldthread {

/// One tile's samples: a place for each pixel and for the replicated samples at or beyond the right
/// and lower edges, rows from the top.
class TileSamples {
 public:
  explicit TileSamples(PixelRect rect);

  const PixelRect& rect() const { return rect_; }
  const Sample& at(int x, int y) const {
    return samples_[static_cast<std::size_t>(y * stride_ + x)];
  }
  const Sample* row(int y) const { return &samples_[static_cast<std::size_t>(y * stride_)]; }
  int stride() const { return stride_; }
  /// The finest level that is whole; nothing if not even the first has come.
  std::optional<Level> level() const;

  /// Puts the samples of a quantum in their places, `samples` in the order of new_samples(). False,
  /// and nothing changed, if they are not as many as that, or the levels make no sense.
  bool place(Level from, Level to, std::span<const Sample> samples);

 private:
  PixelRect rect_;
  int stride_ = 0;
  std::vector<Sample> samples_;
  /// steps_[f] is the finest level that a quantum from level f brought, by binary logarithm.
  std::array<std::optional<Level>, kNoLevel.log2_spacing + 1> steps_;
};

class SampleArray {
 public:
  SampleArray(const TileGrid& grid, Band band);

  /// False if the tile is not of this band, or TileSamples::place refuses.
  bool place(TileId tile, Level from, Level to, std::span<const Sample> samples);
  /// The level that each tile has reached; nothing if one has none. A band without tiles is at the
  /// pixel level.
  std::optional<Level> level() const;
  std::span<const TileSamples> tiles() const { return tiles_; }
  const TileGrid& grid() const { return grid_; }
  /// The band's pixels in the image.
  PixelRect rect() const { return rect_; }

 private:
  TileGrid grid_;
  Band band_;
  PixelRect rect_;
  std::vector<TileSamples> tiles_;
  /// How many tiles are at each level, by binary logarithm; the last counts those without any.
  std::array<std::size_t, kNoLevel.log2_spacing + 1> at_level_{};
};

}  // namespace goldthread
