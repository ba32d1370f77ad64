// SPDX-License-Identifier: Apache-2.0
#include "common/tile/tile_grid.h"

#include <algorithm>

namespace goldthread {
namespace {

constexpr int kLargestImage = 1 << 14;
constexpr int kBlockEdge = 4;

/// The last offset along an axis of `extent` pixels that a grid samples.
int last_offset(int extent, int spacing) {
  if (spacing == 1) return extent - 1;
  return (extent + spacing - 1) / spacing * spacing;
}

}  // namespace

PixelRect TileGrid::rect(TileId id) const {
  const int column = static_cast<int>(id.value) % columns();
  const int row = static_cast<int>(id.value) / columns();
  const int x = column * tile.width;
  const int y = row * tile.height;
  return {x, y, std::min(tile.width, image.width - x), std::min(tile.height, image.height - y)};
}

bool TileGrid::valid() const {
  const auto sane = [](int extent) { return extent > 0 && extent <= kLargestImage; };
  return sane(image.width) && sane(image.height) && sane(tile.width) && sane(tile.height) &&
         tile.width % kCoarsestSpacing == 0 && tile.height % kCoarsestSpacing == 0;
}

TileGrid TileGrid::squares(ImageSize image, int edge) { return {image, {edge, edge}}; }

TileGrid TileGrid::rows_of(ImageSize image) {
  const int width = (image.width + kCoarsestSpacing - 1) / kCoarsestSpacing * kCoarsestSpacing;
  return {image, {width, kCoarsestSpacing}};
}

std::vector<SampleOffset> grid_places(ImageSize size, int spacing) {
  const int last_x = last_offset(size.width, spacing);
  const int last_y = last_offset(size.height, spacing);
  std::vector<SampleOffset> offsets;
  const int block = kBlockEdge * spacing;
  for (int block_y = 0; block_y <= last_y; block_y += block) {
    for (int block_x = 0; block_x <= last_x; block_x += block) {
      for (int y = block_y; y < block_y + block && y <= last_y; y += spacing) {
        for (int x = block_x; x < block_x + block && x <= last_x; x += spacing)
          offsets.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)});
      }
    }
  }
  return offsets;
}

Band band_of(const TileGrid& grid, int index, int count) {
  const auto first = [&](int i) { return static_cast<int>(std::int64_t(grid.rows()) * i / count); };
  return {first(index), first(index + 1)};
}

int band_index(const TileGrid& grid, TileId id, int count) {
  const int row = static_cast<int>(id.value) / grid.columns();
  int index = static_cast<int>(std::int64_t(row) * count / grid.rows());
  while (row >= band_of(grid, index, count).last_row) ++index;
  while (row < band_of(grid, index, count).first_row) --index;
  return index;
}

PixelRect band_rect(const TileGrid& grid, Band band) {
  const int top = band.first_row * grid.tile.height;
  const int bottom = std::min(band.last_row * grid.tile.height, grid.image.height);
  return {0, top, grid.image.width, std::max(0, bottom - top)};
}

}  // namespace goldthread
