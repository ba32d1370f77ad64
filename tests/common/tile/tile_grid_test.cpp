// SPDX-License-Identifier: Apache-2.0
#include "common/tile/tile_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
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

/// Through every second, or every, level from `coarse` down to a pixel.
std::vector<Level> path(Level coarse, int stride) {
  std::vector<Level> levels;
  for (int log2 = coarse.log2_spacing; log2 > 0; log2 -= stride) {
    levels.push_back({static_cast<std::int8_t>(log2)});
  }
  levels.push_back(kPixelLevel);
  return levels;
}

TEST(NewSamples, RefinedByAnyStepsHoldEachPixelExactlyOnce) {
  for (const ImageSize size : kTileSizes) {
    for (std::int8_t coarse = 0; coarse <= kCoarsestLevel.log2_spacing; ++coarse) {
      for (int stride = 1; stride <= 4; ++stride) {
        std::map<Place, int> times;
        Level from = kNoLevel;
        for (const Level to : path({coarse}, stride)) {
          for (const SampleOffset offset : new_samples(size, from, to)) {
            ++times[{offset.x, offset.y}];
          }
          from = to;
        }
        for (int y = 0; y < size.height; ++y) {
          for (int x = 0; x < size.width; ++x) EXPECT_EQ((times[{x, y}]), 1) << x << " " << y;
        }
        for (const auto& [place, count] : times) EXPECT_EQ(count, 1) << "also beyond the edge";
      }
    }
  }
}

TEST(NewSamples, OfTheStepsToALevelCoverWhatTheDirectWayDoes) {
  for (const ImageSize size : kTileSizes) {
    std::set<Place> stepped;
    Level from = kNoLevel;
    for (const Level to : path(kCoarsestLevel, 1)) {
      stepped.merge(places_of(new_samples(size, from, to)));
      const auto direct = places_of(new_samples(size, kNoLevel, to));
      EXPECT_TRUE(std::includes(stepped.begin(), stepped.end(), direct.begin(), direct.end()));
      // What there is beyond it are replicated samples of coarser levels, outside the tile.
      for (const Place& place : stepped) {
        EXPECT_TRUE(direct.contains(place) || place.first >= size.width ||
                    place.second >= size.height);
      }
      from = to;
    }
  }
}

TEST(NewSamples, FromNothingToThePixelLevelAreThePixels) {
  for (const ImageSize size : kTileSizes) {
    const auto places = places_of(new_samples(size, kNoLevel, kPixelLevel));
    EXPECT_EQ(places.size(), std::size_t(size.width) * std::size_t(size.height));
    EXPECT_EQ(*places.rbegin(), Place(size.width - 1, size.height - 1));
  }
}

TEST(NewSamples, AboveThePixelLevelIncludeTheReplicatedColumnAndRow) {
  EXPECT_EQ(new_samples({64, 64}, kNoLevel, {4}).size(), 25u);  // 0, 16, 32, 48 and 64
  EXPECT_EQ(new_samples({64, 64}, kNoLevel, {1}).size(), 33u * 33u);
  for (const ImageSize size : kTileSizes) {
    for (std::int8_t log2 = 1; log2 <= kCoarsestLevel.log2_spacing; ++log2) {
      const int spacing = 1 << log2;
      const auto places = places_of(new_samples(size, kNoLevel, {log2}));
      const auto reach = [&](int extent) { return (extent + spacing - 1) / spacing * spacing; };
      EXPECT_EQ(*places.rbegin(), Place(reach(size.width), reach(size.height)));
      EXPECT_EQ(places.size(), std::size_t(reach(size.width) / spacing + 1) *
                                   std::size_t(reach(size.height) / spacing + 1));
      for (const auto& [x, y] : places) EXPECT_EQ((x | y) % spacing, 0);
    }
  }
}

TEST(NewSamples, ComeInBlocksOfFourByFour) {
  const auto offsets = new_samples({64, 64}, kNoLevel, kPixelLevel);
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    EXPECT_EQ(offsets[i].x / 4, offsets[i - i % 16].x / 4);
    EXPECT_EQ(offsets[i].y / 4, offsets[i - i % 16].y / 4);
  }
}

TEST(NewSamples, StandForTheCentresOfTheirPixels) {
  const PixelPosition position = position_of({128, 64, 64, 64}, {3, 5});
  EXPECT_EQ(position.x, 131.5f);
  EXPECT_EQ(position.y, 69.5f);
}

std::vector<TileGrid> grids() {
  std::vector<TileGrid> result;
  for (const ImageSize image :
       {ImageSize{512, 512}, {1, 1}, {100, 300}, {1920, 1080}, {16, 5000}}) {
    for (const int edge : {16, 32, 64, 256}) result.push_back(TileGrid::squares(image, edge));
    result.push_back(TileGrid::rows_of(image));
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
      EXPECT_EQ(rect.x % grid.tile.width, 0);
      EXPECT_EQ(rect.y % grid.tile.height, 0);
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
  const auto valid = [](ImageSize image, ImageSize tile) { return TileGrid{image, tile}.valid(); };
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
        const int row = static_cast<int>(i) / grid.columns();
        EXPECT_LE(band.first_row, row);
        EXPECT_LT(row, band.last_row);
      }
    }
  }
}

}  // namespace
}  // namespace goldthread
