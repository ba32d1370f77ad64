// SPDX-License-Identifier: Apache-2.0
#include "common/tile/tile_grid.h"

#include <algorithm>

namespace goldthread {
namespace {

constexpr int kLargestImage = 1 << 14;
constexpr int kBlockEdge = 4;
constexpr unsigned kQuarters = 4;

/// The last offset along an axis of `extent` pixels that a grid samples.
int last_offset(int extent, int spacing) {
  if (spacing == 1) return extent - 1;
  return (extent + spacing - 1) / spacing * spacing;
}

/// Leaf `leaf` of a split root, quarter by quarter.
PixelRect leaf_rect(const PixelRect& root, std::uint8_t quarters, std::uint32_t leaf) {
  for (int quarter = 0;; ++quarter) {
    const bool split = ((quarters >> quarter) & 1) != 0;
    const std::uint32_t leaves = split ? kQuarters : 1;
    const PixelRect rect = quarter_of(root, quarter);
    if (leaf < leaves) return split ? quarter_of(rect, static_cast<int>(leaf)) : rect;
    leaf -= leaves;
  }
}

}  // namespace

PixelRect quarter_of(const PixelRect& whole, int quarter) {
  const int width = whole.width / 2, height = whole.height / 2;
  return {whole.x + quarter % 2 * width, whole.y + quarter / 2 * height, width, height};
}

PixelRect TileGrid::root_rect(std::uint32_t root) const {
  const int x = static_cast<int>(root) % columns() * tile.width;
  const int y = static_cast<int>(root) / columns() * tile.height;
  return {x, y, std::min(tile.width, image.width - x), std::min(tile.height, image.height - y)};
}

bool TileGrid::can_split(std::uint32_t root, bool quarters) const {
  const int parts = quarters ? 4 : 2;
  const PixelRect rect = root_rect(root);
  return rect.width == tile.width && rect.height == tile.height &&
         tile.width % (parts * kCoarsestSpacing) == 0 &&
         tile.height % (parts * kCoarsestSpacing) == 0;
}

std::uint32_t TileGrid::count() const { return first_of_row(rows()); }

std::uint32_t TileGrid::first_of_row(int row) const {
  const auto first_root = static_cast<std::uint32_t>(row * columns());
  std::uint32_t tiles = first_root;
  for (const SplitRoot& split : splits) {
    if (split.root >= first_root) break;
    tiles += split.tiles() - 1;
  }
  return tiles;
}

PixelRect TileGrid::rect(TileId id) const {
  std::uint32_t before = 0;  // tiles that splits before this one have made beyond their roots
  for (const SplitRoot& split : splits) {
    if (id.value < split.root + before) break;
    const std::uint32_t leaf = id.value - split.root - before;
    if (leaf < split.tiles()) return leaf_rect(root_rect(split.root), split.quarters, leaf);
    before += split.tiles() - 1;
  }
  return root_rect(id.value - before);
}

std::vector<PixelRect> TileGrid::rects() const {
  std::vector<PixelRect> rects;
  rects.reserve(count());
  auto split = splits.begin();
  for (std::uint32_t root = 0; root < roots(); ++root) {
    const PixelRect whole = root_rect(root);
    if (split == splits.end() || split->root != root) {
      rects.push_back(whole);
      continue;
    }
    for (std::uint32_t leaf = 0; leaf < split->tiles(); ++leaf)
      rects.push_back(leaf_rect(whole, split->quarters, leaf));
    ++split;
  }
  return rects;
}

bool TileGrid::valid() const {
  const auto sane = [](int extent) { return extent > 0 && extent <= kLargestImage; };
  if (!sane(image.width) || !sane(image.height) || !sane(tile.width) || !sane(tile.height) ||
      tile.width % kCoarsestSpacing != 0 || tile.height % kCoarsestSpacing != 0)
    return false;
  std::int64_t before = -1;
  for (const SplitRoot& split : splits) {
    if (split.root <= before || split.root >= roots() || split.quarters >= 1U << kQuarters ||
        !can_split(split.root, split.quarters != 0))
      return false;
    before = split.root;
  }
  return true;
}

TileGrid TileGrid::squares(ImageSize image, int edge) { return {image, {edge, edge}, {}}; }

TileGrid TileGrid::rows_of(ImageSize image) {
  const int width = (image.width + kCoarsestSpacing - 1) / kCoarsestSpacing * kCoarsestSpacing;
  return {image, {width, kCoarsestSpacing}, {}};
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
  const int row = grid.rect(id).y / grid.tile.height;
  int index = static_cast<int>(std::int64_t(row) * count / grid.rows());
  while (row >= band_of(grid, index, count).last_row) ++index;
  while (row < band_of(grid, index, count).first_row) --index;
  return index;
}

TileRange band_tiles(const TileGrid& grid, Band band) {
  return {grid.first_of_row(band.first_row), grid.first_of_row(band.last_row)};
}

PixelRect band_rect(const TileGrid& grid, Band band) {
  const int top = band.first_row * grid.tile.height;
  const int bottom = std::min(band.last_row * grid.tile.height, grid.image.height);
  return {0, top, grid.image.width, std::max(0, bottom - top)};
}

}  // namespace goldthread
