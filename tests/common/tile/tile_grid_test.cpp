// SPDX-License-Identifier: Apache-2.0
#include "common/tile/tile_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace goldthread {
namespace {

using Place = std::pair<int, int>;

const std::vector<ImageSize> kTileSizes{{64, 64}, {16, 16}, {48, 16}, {1, 1},    {1, 64},
                                        {17, 5},  {63, 64}, {33, 20}, {512, 16}, {15, 31}};

std::set<Place> places_of(const std::vector<SampleOffset>& offsets) {
  std::set<Place> places;
  for (const SampleOffset offset : offsets) {
    EXPECT_TRUE(places.insert({offset.x, offset.y}).second)
        << "twice: " << offset.x << " " << offset.y;
  }
  return places;
}

int reach(int extent, int spacing) { return (extent + spacing - 1) / spacing * spacing; }

TEST(GridPlaces, OfEachPixelAreThePixels) {
  for (const ImageSize size : kTileSizes) {
    const auto places = places_of(grid_places(size, 1));
    EXPECT_EQ(places.size(), std::size_t(size.width) * std::size_t(size.height));
    EXPECT_EQ(*places.rbegin(), Place(size.width - 1, size.height - 1));
  }
}

TEST(GridPlaces, AboveThePixelIncludeTheReplicatedColumnAndRow) {
  EXPECT_EQ(grid_places({64, 64}, 16).size(), 25u);  // 0, 16, 32, 48 and 64
  EXPECT_EQ(grid_places({64, 64}, 2).size(), 33u * 33u);
  for (const ImageSize size : kTileSizes) {
    for (int spacing = 2; spacing <= kCoarsestSpacing; spacing *= 2) {
      const auto places = places_of(grid_places(size, spacing));
      const int right = reach(size.width, spacing), below = reach(size.height, spacing);
      EXPECT_EQ(*places.rbegin(), Place(right, below));
      EXPECT_EQ(places.size(), std::size_t(right / spacing + 1) * std::size_t(below / spacing + 1));
      for (const auto& [x, y] : places) EXPECT_EQ((x | y) % spacing, 0);
    }
  }
}

TEST(GridPlaces, OfAFinerGridHoldThoseOfACoarserOneButForReplicatedOnes) {
  for (const ImageSize size : kTileSizes) {
    for (int spacing = kCoarsestSpacing; spacing > 1; spacing /= 2) {
      const auto fine = places_of(grid_places(size, spacing / 2));
      for (const auto& [x, y] : places_of(grid_places(size, spacing))) {
        EXPECT_TRUE(fine.contains({x, y}) || x >= size.width || y >= size.height);
      }
    }
  }
}

TEST(GridPlaces, ComeInBlocksOfFourByFour) {
  for (int spacing = 1; spacing <= 4; spacing *= 2) {
    // With the replicated ones whole blocks.
    const int whole = spacing > 1 ? 64 - spacing : 64;
    const auto offsets = grid_places({whole, whole}, spacing);
    const int edge = 4 * spacing;
    ASSERT_EQ(offsets.size() % 16, 0u);
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      EXPECT_EQ(offsets[i].x / edge, offsets[i - i % 16].x / edge) << spacing;
      EXPECT_EQ(offsets[i].y / edge, offsets[i - i % 16].y / edge) << spacing;
    }
  }
}

TEST(PlacesAlong, AreAsManyAsTheCoarsestGridReachesAndHoldEveryPlace) {
  EXPECT_EQ(places_along(1), 17);
  EXPECT_EQ(places_along(16), 17);
  EXPECT_EQ(places_along(17), 33);
  EXPECT_EQ(places_along(64), 65);
  for (const ImageSize size : kTileSizes) {
    for (int spacing = 1; spacing <= kCoarsestSpacing; spacing *= 2) {
      for (const SampleOffset offset : grid_places(size, spacing)) {
        EXPECT_LT(offset.x, places_along(size.width));
        EXPECT_LT(offset.y, places_along(size.height));
      }
    }
    const SampleOffset last = grid_places(size, kCoarsestSpacing).back();
    EXPECT_EQ(last.x + 1, places_along(size.width)) << "none is there in vain";
    EXPECT_EQ(last.y + 1, places_along(size.height));
  }
}

TEST(SampleOffset, StandsForTheCentreOfItsPixel) {
  const PixelPosition position = position_of({128, 64, 64, 64}, {3, 5});
  EXPECT_EQ(position.x, 131.5f);
  EXPECT_EQ(position.y, 69.5f);
}

/// Every third root that can be is split, with each choice of quarters in turn.
TileGrid with_splits(TileGrid grid) {
  std::uint8_t quarters = 0;
  for (std::uint32_t root = 0; root < grid.roots(); root += 3) {
    const bool deep = grid.can_split(root, true);
    if (grid.can_split(root, false))
      grid.splits.push_back({root, deep ? quarters : std::uint8_t(0)});
    quarters = static_cast<std::uint8_t>((quarters + 1) % 16);
  }
  return grid;
}

std::vector<TileGrid> grids() {
  std::vector<TileGrid> result;
  for (const ImageSize image :
       {ImageSize{512, 512}, {1, 1}, {100, 300}, {1920, 1080}, {16, 5000}}) {
    for (const int edge : {16, 32, 64, 256}) result.push_back(TileGrid::squares(image, edge));
    result.push_back(TileGrid::rows_of(image));
    for (const int edge : {32, 64, 128})
      result.push_back(with_splits(TileGrid::squares(image, edge)));
  }
  return result;
}

TEST(TileGrid, PartitionsTheImage) {
  for (const TileGrid& grid : grids()) {
    ASSERT_TRUE(grid.valid());
    std::int64_t pixels = 0;
    std::set<Place> corners;
    for (std::uint32_t i = 0; i < grid.count(); ++i) {
      const PixelRect rect = grid.rect({i});
      EXPECT_EQ(rect.x % kCoarsestSpacing, 0);
      EXPECT_EQ(rect.y % kCoarsestSpacing, 0);
      EXPECT_GT(rect.width, 0);
      EXPECT_GT(rect.height, 0);
      EXPECT_LE(rect.x + rect.width, grid.image.width);
      EXPECT_LE(rect.y + rect.height, grid.image.height);
      EXPECT_TRUE(corners.insert({rect.x, rect.y}).second);
      pixels += std::int64_t(rect.width) * rect.height;
    }
    EXPECT_EQ(pixels, std::int64_t(grid.image.width) * grid.image.height);
  }
}

/// Which pixels belong to which tile, one by one, is the oracle: no area, no sum can hide a gap.
TEST(TileGrid, OfSplitRootsCoversEachPixelOnce) {
  const TileGrid grid = with_splits(TileGrid::squares({300, 200}, 64));
  ASSERT_FALSE(grid.splits.empty());
  std::vector<int> covered(300 * 200);
  for (const PixelRect& rect : grid.rects())
    for (int y = rect.y; y < rect.y + rect.height; ++y)
      for (int x = rect.x; x < rect.x + rect.width; ++x) ++covered[std::size_t(y * 300 + x)];
  EXPECT_TRUE(std::all_of(covered.begin(), covered.end(), [](int times) { return times == 1; }));
}

TEST(TileGrid, NumbersTilesRootByRootAndQuarterByQuarter) {
  TileGrid grid = TileGrid::squares({192, 128}, 64);
  grid.splits = {{1, 0b1000}, {3, 0}};
  const std::vector<PixelRect> expected{
      {0, 0, 64, 64},    {64, 0, 32, 32},  {96, 0, 32, 32},   {64, 32, 32, 32}, {96, 32, 16, 16},
      {112, 32, 16, 16}, {96, 48, 16, 16}, {112, 48, 16, 16}, {128, 0, 64, 64}, {0, 64, 32, 32},
      {32, 64, 32, 32},  {0, 96, 32, 32},  {32, 96, 32, 32},  {64, 64, 64, 64}, {128, 64, 64, 64}};
  EXPECT_EQ(grid.rects(), expected);
  ASSERT_EQ(grid.count(), expected.size());
  for (std::uint32_t i = 0; i < grid.count(); ++i) EXPECT_EQ(grid.rect({i}), expected[i]) << i;
  EXPECT_EQ(grid.first_of_row(0), 0u);
  EXPECT_EQ(grid.first_of_row(1), 9u);
  EXPECT_EQ(grid.first_of_row(2), 15u);
}

TEST(TileGrid, FindsEachTileAsTheListOfAllHasIt) {
  for (const TileGrid& grid : grids()) {
    const auto rects = grid.rects();
    ASSERT_EQ(rects.size(), grid.count());
    for (std::uint32_t i = 0; i < grid.count(); ++i) ASSERT_EQ(grid.rect({i}), rects[i]);
  }
}

TEST(TileGrid, RefusesSplitsThatAreNotSane) {
  const auto valid = [](ImageSize image, int edge, std::vector<SplitRoot> splits) {
    return TileGrid{image, {edge, edge}, std::move(splits)}.valid();
  };
  const ImageSize image{192, 130};  // 3×3 roots of 64×64, the last row clipped
  EXPECT_TRUE(valid(image, 64, {{0, 0}, {1, 15}, {5, 7}}));
  EXPECT_FALSE(valid(image, 64, {{0, 16}})) << "a fifth quarter";
  EXPECT_FALSE(valid(image, 64, {{1, 0}, {1, 0}})) << "twice";
  EXPECT_FALSE(valid(image, 64, {{2, 0}, {1, 0}})) << "out of order";
  EXPECT_FALSE(valid(image, 64, {{9, 0}})) << "no such root";
  EXPECT_FALSE(valid(image, 64, {{0xffffffff, 0}}));
  EXPECT_FALSE(valid(image, 64, {{6, 0}})) << "a clipped one";
  EXPECT_FALSE(valid(image, 16, {{0, 0}})) << "quarters of 8 pixels";
  EXPECT_TRUE(valid(image, 32, {{0, 0}}));
  EXPECT_FALSE(valid(image, 32, {{0, 1}})) << "quarters of quarters of 8 pixels";
  EXPECT_FALSE(valid(image, 48, {{0, 0}})) << "quarters of 24 pixels";
  EXPECT_FALSE(valid({0, 0}, 0, {{0, 0}}));
}

TEST(TileGrid, ClipsItsLastTiles) {
  const TileGrid grid = TileGrid::squares({100, 70}, 64);
  EXPECT_EQ(grid.count(), 4u);
  EXPECT_EQ(grid.rect({3}), (PixelRect{64, 64, 36, 6}));
}

TEST(TileGrid, OfRowsHasOneTileAcross) {
  const TileGrid grid = TileGrid::rows_of({100, 70});
  EXPECT_EQ(grid.columns(), 1);
  EXPECT_EQ(grid.rows(), 5);
  EXPECT_EQ(grid.rect({4}), (PixelRect{0, 64, 100, 6}));
}

TEST(TileGrid, RefusesSizesThatAreNotSane) {
  const auto valid = [](ImageSize image, ImageSize tile) {
    return TileGrid{image, tile, {}}.valid();
  };
  EXPECT_TRUE(valid({1, 1}, {16, 16}));
  EXPECT_TRUE(valid({16384, 16384}, {16384, 16}));
  EXPECT_FALSE(valid({0, 1}, {16, 16}));
  EXPECT_FALSE(valid({1, -1}, {16, 16}));
  EXPECT_FALSE(valid({16385, 1}, {16, 16}));
  EXPECT_FALSE(valid({1, 1}, {0, 16}));
  EXPECT_FALSE(valid({1, 1}, {16, -16}));
  EXPECT_FALSE(valid({1, 1}, {16, 24}));
  EXPECT_FALSE(valid({1, 1}, {16400, 16}));
  EXPECT_FALSE(valid({}, {}));
}

TEST(Bands, PartitionTheRowsEvenlyForAnyCount) {
  for (const TileGrid& grid : grids()) {
    for (int count = 1; count <= 40; ++count) {
      int next = 0;
      int least = grid.rows(), most = 0;
      std::int64_t pixels = 0;
      for (int i = 0; i < count; ++i) {
        const Band band = band_of(grid, i, count);
        EXPECT_EQ(band.first_row, next);
        EXPECT_GE(band.last_row, band.first_row);
        next = band.last_row;
        least = std::min(least, band.last_row - band.first_row);
        most = std::max(most, band.last_row - band.first_row);
        const PixelRect rect = band_rect(grid, band);
        EXPECT_GE(rect.height, 0);
        pixels += std::int64_t(rect.width) * rect.height;
      }
      EXPECT_EQ(next, grid.rows());
      EXPECT_LE(most - least, 1);
      EXPECT_EQ(pixels, std::int64_t(grid.image.width) * grid.image.height);
    }
  }
}

TEST(Bands, HoldTheTilesOfTheirIndex) {
  for (const TileGrid& grid : grids()) {
    for (int count = 1; count <= 40; ++count) {
      for (std::uint32_t i = 0; i < grid.count(); i += 7) {
        const int index = band_index(grid, {i}, count);
        ASSERT_GE(index, 0);
        ASSERT_LT(index, count);
        const Band band = band_of(grid, index, count);
        const PixelRect tile = grid.rect({i}), all = band_rect(grid, band);
        EXPECT_LE(all.y, tile.y);
        EXPECT_LE(tile.y + tile.height, all.y + all.height);
        const TileRange tiles = band_tiles(grid, band);
        EXPECT_LE(tiles.first, i);
        EXPECT_LT(i, tiles.last);
      }
    }
  }
}

}  // namespace
}  // namespace goldthread
