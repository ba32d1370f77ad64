// SPDX-License-Identifier: Apache-2.0
#pragma once
// How the screen is cut: tiles (sample squares, or sample rows), dear ones split, regular grids of
// samples in a tile, and the compositors' bands. Pure geometry that master, workers and compositors
// agree on.

#include <bit>
#include <compare>
#include <cstdint>
#include <tuple>
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

/// A root of a grid that is split into quarters.
struct SplitRoot {
  std::uint32_t root = 0;  ///< its number, row by row
  std::uint8_t quarters =
      0;  ///< bit q: quarter q (of the first row, then the second) is split, too
  bool operator==(const SplitRoot&) const = default;
  static constexpr auto fields() { return std::tuple{&SplitRoot::root, &SplitRoot::quarters}; }

  /// How many tiles it has become.
  std::uint32_t tiles() const {
    return 4 + 3 * static_cast<std::uint32_t>(std::popcount(quarters));
  }
};

/// A quarter of a rectangle with even sides: 0 and 1 the upper ones, 2 and 3 the lower.
PixelRect quarter_of(const PixelRect& whole, int quarter);

/// The picture cut into roots of `tile` pixels, from the top left; the last ones may be smaller. A
/// root is a tile, or is split into quarters, and each of these, once more, into quarters: the
/// leaves of these trees are the tiles, numbered root by root.
struct TileGrid {
  ImageSize image;
  ImageSize tile;                      ///< of a root; multiples of the coarsest level's spacing
  std::vector<SplitRoot> splits = {};  ///< by growing root
  bool operator==(const TileGrid&) const = default;
  static constexpr auto fields() {
    return std::tuple{&TileGrid::image, &TileGrid::tile, &TileGrid::splits};
  }

  /// Of roots.
  int columns() const { return (image.width + tile.width - 1) / tile.width; }
  int rows() const { return (image.height + tile.height - 1) / tile.height; }
  std::uint32_t roots() const { return static_cast<std::uint32_t>(columns() * rows()); }
  /// The pixels of a root, clipped to the image.
  PixelRect root_rect(std::uint32_t root) const;
  /// Whether a root can be split, and its quarters: whole in the image, and quarters are multiples
  /// of the coarsest spacing.
  bool can_split(std::uint32_t root, bool quarters) const;

  std::uint32_t count() const;
  /// The pixels of a tile, clipped to the image. Time grows with the number of splits: rects() for
  /// all.
  PixelRect rect(TileId id) const;
  /// Those of all tiles, in order.
  std::vector<PixelRect> rects() const;
  /// The number of a row's first tile; of row rows(), how many there are.
  std::uint32_t first_of_row(int row) const;

  /// Whether the sizes are sane: positive, within limits, roots multiples of 16; and only roots
  /// that can be are split, each once. For bytes of a peer.
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

/// The rows of roots [first, last) of compositor `index` of `count`, as even as whole rows allow.
struct Band {
  int first_row = 0;
  int last_row = 0;
};
Band band_of(const TileGrid& grid, int index, int count);
/// Which compositor's band holds a tile.
int band_index(const TileGrid& grid, TileId id, int count);
/// The tiles [first, last) of a band.
struct TileRange {
  std::uint32_t first = 0;
  std::uint32_t last = 0;
};
TileRange band_tiles(const TileGrid& grid, Band band);
/// A band's pixels.
PixelRect band_rect(const TileGrid& grid, Band band);

}  // namespace goldthread
