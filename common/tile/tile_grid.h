// SPDX-License-Identifier: Apache-2.0
#pragma once
// How the screen is cut: tiles (sample squares, or sample rows), the levels of samples in a tile,
// and the compositors' bands. Pure geometry that master, workers and compositors agree on.

#include <cstdint>
#include <vector>

#include "common/base/types.h"
#include "common/tile/sample.h"

namespace goldthread {

/// A level of samples, by the binary logarithm of their spacing in pixels: 4 is one sample in 16×16
/// pixels, 0 one in each pixel.
struct Level {
  std::int8_t log2_spacing = 0;
  int spacing_px() const { return 1 << log2_spacing; }
  Level finer() const { return {static_cast<std::int8_t>(log2_spacing - 1)}; }
  bool operator==(const Level&) const = default;
  static constexpr auto fields() { return std::tuple{&Level::log2_spacing}; }
};
constexpr Level kCoarsestLevel{4};
constexpr Level kPixelLevel{0};
/// As a quantum's `from`: the tile holds nothing yet.
constexpr Level kNoLevel{5};
/// Whether there are levels that take a tile from `from` to `to`. For bytes of a peer.
constexpr bool is_step(Level from, Level to) {
  return kPixelLevel.log2_spacing <= to.log2_spacing && to.log2_spacing < from.log2_spacing &&
         from.log2_spacing <= kNoLevel.log2_spacing;
}

/// A sample's place in its tile, in pixels from the tile's first.
struct SampleOffset {
  std::uint16_t x = 0;
  std::uint16_t y = 0;
  bool operator==(const SampleOffset&) const = default;
};

/// The picture cut into tiles of `tile` pixels, from the top left; the last ones may be smaller.
struct TileGrid {
  ImageSize image;
  ImageSize tile;  ///< multiples of the coarsest level's spacing
  bool operator==(const TileGrid&) const = default;
  static constexpr auto fields() { return std::tuple{&TileGrid::image, &TileGrid::tile}; }

  int columns() const { return (image.width + tile.width - 1) / tile.width; }
  int rows() const { return (image.height + tile.height - 1) / tile.height; }
  std::uint32_t count() const { return static_cast<std::uint32_t>(columns() * rows()); }
  /// The pixels of a tile, clipped to the image.
  PixelRect rect(TileId id) const;
  /// Whether the sizes are sane: positive, within limits, tiles multiples of 16. For bytes of a
  /// peer.
  bool valid() const;

  static TileGrid squares(ImageSize image, int edge);
  /// Full-width rows, as high as the coarsest level's spacing: VOL2's sample rows.
  static TileGrid rows_of(ImageSize image);
};

/// The samples that take a tile of `size` pixels from level `from` (kNoLevel: from nothing) to the
/// finer level `to` (is_step(from, to)), each once, in the one order in which they travel: in
/// blocks of 4×4, for the sake of coherent packets. Above the pixel level they include the
/// replicated column and row at or beyond the right and lower edges, so that each tile can be
/// reconstructed alone.
std::vector<SampleOffset> new_samples(ImageSize size, Level from, Level to);

/// The centre of the pixel that a sample stands for.
inline PixelPosition position_of(const PixelRect& tile, SampleOffset offset) {
  return {static_cast<float>(tile.x + offset.x) + 0.5f,
          static_cast<float>(tile.y + offset.y) + 0.5f};
}

/// The tile rows [first, last) of compositor `index` of `count`, as even as whole rows allow.
struct Band {
  int first_row = 0;
  int last_row = 0;
};
Band band_of(const TileGrid& grid, int index, int count);
/// Which compositor's band holds a tile.
int band_index(const TileGrid& grid, TileId id, int count);
/// A band's pixels.
PixelRect band_rect(const TileGrid& grid, Band band);

}  // namespace goldthread
