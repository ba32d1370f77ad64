// SPDX-License-Identifier: Apache-2.0
#include "compositor/sample_array.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace goldthread {
namespace {

/// A sample that tells where it belongs.
Sample sample_at(const PixelRect& rect, SampleOffset offset) {
  return {static_cast<float>(rect.x + offset.x), static_cast<float>(rect.y + offset.y), 0.5f, 1};
}

struct Step {
  TileId tile;
  Level from, to;
};

std::vector<Sample> samples_of(const TileGrid& grid, const Step& step) {
  const PixelRect rect = grid.rect(step.tile);
  std::vector<Sample> samples;
  for (const auto offset : new_samples({rect.width, rect.height}, step.from, step.to)) {
    samples.push_back(sample_at(rect, offset));
  }
  return samples;
}

bool place(SampleArray& array, const Step& step) {
  return array.place(step.tile, step.from, step.to, samples_of(array.grid(), step));
}

std::vector<Step> all_steps(const TileGrid& grid) {
  std::vector<Step> steps;
  for (std::uint32_t i = 0; i < grid.count(); ++i) {
    for (std::int8_t to = 4; to >= 0; --to) {
      steps.push_back({{i}, {static_cast<std::int8_t>(to + 1)}, {to}});
    }
  }
  return steps;
}

SampleArray whole(const TileGrid& grid) { return {grid, band_of(grid, 0, 1)}; }

const TileGrid kGrid = TileGrid::squares({100, 70}, 64);

TEST(SampleArray, HoldsTheSameAfterAnyOrderOfQuanta) {
  std::mt19937 random(1);
  auto steps = all_steps(kGrid);
  for (int trial = 0; trial < 20; ++trial) {
    std::shuffle(steps.begin(), steps.end(), random);
    SampleArray array = whole(kGrid);
    for (const Step& step : steps) ASSERT_TRUE(place(array, step));
    EXPECT_EQ(array.level(), kPixelLevel);
    for (const TileSamples& tile : array.tiles()) {
      for (int y = 0; y < tile.rect().height; ++y) {
        for (int x = 0; x < tile.rect().width; ++x) {
          const SampleOffset offset{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)};
          ASSERT_EQ(tile.at(x, y), sample_at(tile.rect(), offset));
        }
      }
    }
  }
}

TEST(SampleArray, IsAtTheLevelThatEachTileHasReached) {
  SampleArray array = whole(kGrid);
  EXPECT_FALSE(array.level());
  for (std::uint32_t i = 0; i < 3; ++i) ASSERT_TRUE(place(array, {{i}, kNoLevel, {4}}));
  EXPECT_FALSE(array.level()) << "one tile has none";
  ASSERT_TRUE(place(array, {{3}, kNoLevel, {4}}));
  EXPECT_EQ(array.level(), Level{4});
  for (std::uint32_t i = 0; i < 4; ++i) {
    EXPECT_EQ(array.level(), Level{4});
    ASSERT_TRUE(place(array, {{i}, {4}, {1}}));
  }
  EXPECT_EQ(array.level(), Level{1});
}

TEST(SampleArray, CountsALevelOnlyWithAllCoarserOnes) {
  SampleArray array = whole(TileGrid::squares({64, 64}, 64));
  ASSERT_TRUE(place(array, {{0}, {3}, {0}}));
  EXPECT_FALSE(array.level());
  ASSERT_TRUE(place(array, {{0}, kNoLevel, {4}}));
  EXPECT_EQ(array.level(), Level{4});
  ASSERT_TRUE(place(array, {{0}, {4}, {3}}));
  EXPECT_EQ(array.level(), kPixelLevel);
}

TEST(SampleArray, DoesNotFallBackWhenACoarserQuantumComesLate) {
  SampleArray array = whole(TileGrid::squares({64, 64}, 64));
  ASSERT_TRUE(place(array, {{0}, kNoLevel, {0}}));
  ASSERT_TRUE(place(array, {{0}, kNoLevel, {4}}));
  EXPECT_EQ(array.level(), kPixelLevel);
}

TEST(SampleArray, TakesAQuantumTwiceAsOnce) {
  SampleArray array = whole(TileGrid::squares({64, 64}, 64));
  ASSERT_TRUE(place(array, {{0}, kNoLevel, {4}}));
  ASSERT_TRUE(place(array, {{0}, kNoLevel, {4}}));
  EXPECT_EQ(array.level(), Level{4});
}

TEST(SampleArray, RefusesWrongCountsTilesAndLevels) {
  SampleArray array(kGrid, band_of(kGrid, 1, 2));  // tiles 2 and 3
  auto samples = samples_of(kGrid, {{2}, kNoLevel, {4}});
  EXPECT_FALSE(array.place({0}, kNoLevel, {4}, samples)) << "of the band above";
  EXPECT_FALSE(array.place({4}, kNoLevel, {4}, samples)) << "beyond the grid";
  EXPECT_FALSE(array.place({~0u}, kNoLevel, {4}, samples));
  for (int from = -128; from < 128; ++from) {
    for (int to = -128; to < 128; ++to) {
      if (0 <= to && to < from && from <= 5) continue;
      const Level a{static_cast<std::int8_t>(from)}, b{static_cast<std::int8_t>(to)};
      ASSERT_FALSE(array.place({2}, a, b, samples)) << from << " " << to;
    }
  }
  samples.push_back({});
  EXPECT_FALSE(array.place({2}, kNoLevel, {4}, samples)) << "one too many";
  samples.resize(samples.size() - 2);
  EXPECT_FALSE(array.place({2}, kNoLevel, {4}, samples)) << "one too few";
  EXPECT_FALSE(array.place({2}, kNoLevel, {4}, {})) << "none";
  EXPECT_FALSE(array.tiles()[0].level()) << "nothing changed";
  EXPECT_EQ(array.tiles()[0].at(0, 0), Sample{});
}

TEST(SampleArray, OfABandWithoutTilesIsAtThePixelLevel) {
  const SampleArray array(kGrid, band_of(kGrid, 0, 5));
  EXPECT_TRUE(array.tiles().empty());
  EXPECT_EQ(array.level(), kPixelLevel);
  EXPECT_EQ(array.rect().height, 0);
}

TEST(SampleArray, HoldsEveryReplicatedSampleOfEveryTileSize) {
  for (const ImageSize image : {ImageSize{1, 1}, {16, 16}, {17, 31}, {65, 200}}) {
    for (const TileGrid& grid : {TileGrid::squares(image, 16), TileGrid::rows_of(image)}) {
      SampleArray array = whole(grid);
      for (const Step& step : all_steps(grid)) ASSERT_TRUE(place(array, step));
      EXPECT_EQ(array.level(), kPixelLevel);
    }
  }
}

}  // namespace
}  // namespace goldthread
