// SPDX-License-Identifier: Apache-2.0
#pragma once
// How the screen is cut: tiles (sample squares, or sample rows), regular grids of samples in a
// tile, and the compositors' bands. Pure geometry that master, workers and compositors agree on.

#include <compare>
#include <cstdint>
#include <vector>

#include "common/base/types.h"
#include "common/tile/sample.h"

namespace goldthread {

/// The distance of the samples that every tile begins with, in pixels.
constexpr int kCoarsestSpacing = 16;
/// Places along an axis of a tile of `extent` pixels: one for each pixel and, at or beyond the far
/// edge, the replicated ones up to the next multiple of the coarsest spacing.
constexpr int places_along(int extent) {
  return (extent + kCoarsestSpacing - 1) / kCoarsestSpacing * kCoarsestSpacing + 1;
}

/// A sample's place in its tile, in pixels from the tile's first.
struct SampleOffset {
  std::uint16_t x = 0;
  std::uint16_t y = 0;
  auto operator<=>(const SampleOffset&) const = default;
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

/// The places of a regular grid of samples in a tile of `size` pixels, each once, in blocks of 4×4
/// for the sake of coherent packets. Above the pixel (`spacing` > 1) they include the replicated
/// column and row at or beyond the right and lower edges, so that each tile can be reconstructed
/// alone.
std::vector<SampleOffset> grid_places(ImageSize size, int spacing);

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
