// SPDX-License-Identifier: Apache-2.0
#include "compositor/sample_array.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/compositor/packed_samples.h"

namespace goldthread {
namespace {

struct Quantum {
  TileId tile;
  Step from, to;
};

const TileGrid kGrid = TileGrid::squares({100, 70}, 64);
const TileGrid kOneTile = TileGrid::squares({64, 64}, 64);

SampleArray whole(const TileGrid& grid) { return {grid, band_of(grid, 0, 1)}; }

/// Each sample tells where it belongs and which step brought it.
bool place(SampleArray& array, const Quantum& quantum) {
  return array.place(
      packed_grid(array.grid(), quantum.tile, quantum.from, quantum.to, [&](float x, float y) {
        return Sample{x, y, static_cast<float>(quantum.to.value), 1};
      }));
}

std::vector<Quantum> all_quanta(const TileGrid& grid) {
  std::vector<Quantum> quanta;
  for (std::uint32_t i = 0; i < grid.count(); ++i)
    for (Step from = kNoStep; from < kPixelStep; from = from.next())
      quanta.push_back({{i}, from, from.next()});
  return quanta;
}

/// The last step whose grid has a place; 0: none has.
int last_step_of(ImageSize tile, int x, int y) {
  int last = 0;
  for (Step step{1}; step <= kPixelStep; step = step.next()) {
    const auto places = grid_places(tile, spacing_of(step));
    const SampleOffset place{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)};
    if (std::find(places.begin(), places.end(), place) != places.end()) last = step.value;
  }
  return last;
}

void expect_latest_everywhere(const TileSamples& tile, const std::vector<int>& expected) {
  for (int y = 0; y < tile.rows(); ++y) {
    for (int x = 0; x < tile.stride(); ++x) {
      const auto at = static_cast<std::size_t>(y * tile.stride() + x);
      ASSERT_EQ(int(tile.known()[at]), expected[at]) << x << " " << y;
      const Sample sample{float(tile.rect().x + x) + 0.5f, float(tile.rect().y + y) + 0.5f,
                          float(expected[at]), 1};
      ASSERT_EQ(tile.samples()[at], expected[at] == 0 ? Sample{} : sample) << x << " " << y;
    }
  }
}

std::vector<int> latest_steps(const TileSamples& tile) {
  std::vector<int> steps;
  for (int y = 0; y < tile.rows(); ++y)
    for (int x = 0; x < tile.stride(); ++x)
      steps.push_back(last_step_of({tile.rect().width, tile.rect().height}, x, y));
  return steps;
}

TEST(SampleArray, HoldsTheLatestStepsSamplesAfterAnyOrderOfQuanta) {
  std::mt19937 random(1);
  const TileGrid grid = TileGrid::squares({50, 20}, 32);
  auto quanta = all_quanta(grid);
  const SampleArray empty = whole(grid);
  std::vector<std::vector<int>> expected;
  for (const TileSamples& tile : empty.tiles()) expected.push_back(latest_steps(tile));
  for (int trial = 0; trial < 50; ++trial) {
    std::shuffle(quanta.begin(), quanta.end(), random);
    SampleArray array = whole(grid);
    for (const Quantum& quantum : quanta) ASSERT_TRUE(place(array, quantum));
    EXPECT_EQ(array.step(), kPixelStep);
    for (std::size_t i = 0; i < expected.size(); ++i)
      expect_latest_everywhere(array.tiles()[i], expected[i]);
    if (HasFatalFailure()) return;
  }
}

TEST(SampleArray, NeverPutsAnOlderStepOverANewerOne) {
  SampleArray array = whole(kOneTile);
  const std::vector<SampleOffset> places{{3, 5}};
  ASSERT_TRUE(array.place(packed({0}, {6}, {7}, places, {{0.7f, 0, 0, 1}})));
  ASSERT_TRUE(array.place(packed({0}, {2}, {3}, places, {{0.3f, 0, 0, 1}})));
  const std::size_t at = 5 * 65 + 3;
  EXPECT_EQ(array.tiles()[0].samples()[at].red, 0.7f);
  EXPECT_EQ(array.tiles()[0].known()[at], 7);
  ASSERT_TRUE(array.place(packed({0}, {7}, {8}, places, {{0.8f, 0, 0, 1}})));
  EXPECT_EQ(array.tiles()[0].samples()[at].red, 0.8f);
}

TEST(SampleArray, IsAtTheStepThatEachTileHasTaken) {
  SampleArray array = whole(kGrid);
  EXPECT_EQ(array.step(), kNoStep);
  for (std::uint32_t i = 0; i < 3; ++i) ASSERT_TRUE(place(array, {{i}, kNoStep, {1}}));
  EXPECT_EQ(array.step(), kNoStep) << "one tile has none";
  ASSERT_TRUE(place(array, {{3}, kNoStep, {1}}));
  EXPECT_EQ(array.step(), Step{1});
  for (std::uint32_t i = 0; i < 4; ++i) {
    EXPECT_EQ(array.step(), Step{1});
    ASSERT_TRUE(place(array, {{i}, {1}, {4}}));
  }
  EXPECT_EQ(array.step(), Step{4});
}

TEST(SampleArray, CountsAStepOnlyWithAllBefore) {
  SampleArray array = whole(kOneTile);
  ASSERT_TRUE(place(array, {{0}, {2}, {5}}));
  EXPECT_EQ(array.step(), kNoStep);
  ASSERT_TRUE(place(array, {{0}, kNoStep, {1}}));
  EXPECT_EQ(array.step(), Step{1});
  ASSERT_TRUE(place(array, {{0}, {1}, {2}}));
  EXPECT_EQ(array.step(), Step{5}) << "the one that was ahead counts now";
}

TEST(SampleArray, CountsAStepWithoutAnyChange) {
  SampleArray array = whole(kOneTile);
  ASSERT_TRUE(place(array, {{0}, kNoStep, {1}}));
  ASSERT_TRUE(array.place(packed({0}, {1}, {2}, {}, {})));
  EXPECT_EQ(array.step(), Step{2});
}

TEST(SampleArray, TakesReplayedAndOverlappingQuantaAsOnce) {
  const std::vector<Quantum> once{{{0}, {0}, {1}}, {{0}, {1}, {2}}, {{0}, {2}, {3}}};
  auto many = once;
  many.insert(many.end(), {{{0}, {0}, {1}}, {{0}, {1}, {2}}, {{0}, {1}, {3}}, {{0}, {0}, {3}}});
  SampleArray expected = whole(kOneTile);
  for (const Quantum& quantum : once) ASSERT_TRUE(place(expected, quantum));
  std::mt19937 random(2);
  for (int trial = 0; trial < 20; ++trial) {
    std::shuffle(many.begin(), many.end(), random);
    SampleArray array = whole(kOneTile);
    for (const Quantum& quantum : many) ASSERT_TRUE(place(array, quantum));
    EXPECT_EQ(array.step(), Step{3});
    EXPECT_TRUE(std::ranges::equal(array.tiles()[0].samples(), expected.tiles()[0].samples()));
    EXPECT_TRUE(std::ranges::equal(array.tiles()[0].known(), expected.tiles()[0].known()));
  }
}

TEST(SampleArray, DoesNotFallBackWhenAnEarlierQuantumComesLate) {
  SampleArray array = whole(kOneTile);
  ASSERT_TRUE(place(array, {{0}, kNoStep, {5}}));
  ASSERT_TRUE(place(array, {{0}, kNoStep, {1}}));
  EXPECT_EQ(array.step(), Step{5});
}

TEST(SampleArray, TakesAllStepsThatThereAre) {
  SampleArray array = whole(kOneTile);
  for (Step step = kNoStep; step < kLastStep; step = step.next()) {
    EXPECT_EQ(array.step(), step);
    ASSERT_TRUE(
        array.place(packed({0}, step, step.next(), {{0, 0}}, {{float(step.value), 0, 0, 1}})));
  }
  EXPECT_EQ(array.step(), kLastStep);
  EXPECT_EQ(array.tiles()[0].known()[0], kLastStep.value);
  EXPECT_EQ(array.tiles()[0].samples()[0].red, kLastStep.value - 1);
}

/// Nothing of it is known, and no step taken.
void expect_untouched(const SampleArray& array) {
  for (const TileSamples& tile : array.tiles()) {
    EXPECT_EQ(tile.step(), kNoStep);
    EXPECT_EQ(std::ranges::count(tile.known(), 0), std::ptrdiff_t(tile.known().size()));
    EXPECT_EQ(std::ranges::count(tile.samples(), Sample{}), std::ptrdiff_t(tile.samples().size()));
  }
}

TEST(SampleArray, RefusesTilesOfOtherBandsAndNone) {
  SampleArray array(kGrid, band_of(kGrid, 1, 2));  // tiles 2 and 3
  for (const std::uint32_t tile : {0u, 1u, 4u, 1000u, ~0u})
    EXPECT_FALSE(array.place(packed({tile}, kNoStep, {1}, {{0, 0}}, {{1, 1, 1, 1}}))) << tile;
  expect_untouched(array);
  EXPECT_TRUE(array.place(packed({2}, kNoStep, {1}, {{0, 0}}, {{1, 1, 1, 1}})));
}

TEST(SampleArray, RefusesStepsThatAreNone) {
  SampleArray array = whole(kOneTile);
  const std::uint16_t last = kLastStep.value;
  const std::uint16_t beyond = last + 1;
  const std::pair<std::uint16_t, std::uint16_t> bad[] = {
      {0, 0},           {1, 1},        {2, 1},    {last, last}, {0, beyond},
      {last, beyond},   {beyond, 202}, {0, 256},  {0, 0xffff},  {0xffff, 1},
      {0xfffe, 0xffff}, {beyond, 1},   {255, 256}};
  for (const auto& [from, to] : bad) {
    EXPECT_FALSE(array.place(packed({0}, {from}, {to}, {{0, 0}}, {{1, 1, 1, 1}})))
        << from << " " << to;
  }
  expect_untouched(array);
}

TEST(SampleArray, RefusesPlacesOutsideTheTileAndThenChangesNothing) {
  // 100×70 in tiles of 64: the last one has 36×6 pixels, 49×17 places.
  SampleArray array = whole(kGrid);
  const std::vector<Sample> two(2, Sample{1, 1, 1, 1});
  const std::vector<SampleOffset> outside{{49, 0},     {0, 17},     {49, 17},
                                          {0xffff, 0}, {0, 0xffff}, {0xffff, 0xffff}};
  for (const SampleOffset place : outside) {
    EXPECT_FALSE(array.place(packed({3}, kNoStep, {1}, {{0, 0}, place}, two)));
    EXPECT_FALSE(array.place(packed({3}, kNoStep, {1}, {place, {0, 0}}, two)));
  }
  expect_untouched(array);
  EXPECT_TRUE(array.place(packed({3}, kNoStep, {1}, {{48, 16}, {0, 0}}, two))) << "the last one";
}

TEST(SampleArray, RefusesBytesThatAreNotAsManyAsTheCountSays) {
  SampleArray array = whole(kOneTile);
  const std::size_t each = sizeof(Sample) + sizeof(SampleOffset);
  for (const std::uint32_t count : {0u, 1u, 2u, 3u, 4u, 0x0ccccccdu, 0x7fffffffu, 0xffffffffu}) {
    for (std::size_t bytes = 0; bytes <= 4 * each; ++bytes) {
      if (bytes == count * each) continue;
      Samples message{{1}, {0}, kNoStep, {1}, count, Buffer(bytes)};
      if (bytes > 0) std::memset(message.packed.data(), 0, bytes);
      ASSERT_FALSE(array.place(message)) << count << " in " << bytes;
    }
  }
  expect_untouched(array);
}

TEST(SampleArray, OfABandWithoutTilesHasTakenEveryStep) {
  const SampleArray array(kGrid, band_of(kGrid, 0, 5));
  EXPECT_TRUE(array.tiles().empty());
  EXPECT_EQ(array.step(), kLastStep);
  EXPECT_EQ(array.rect().height, 0);
}

TEST(SampleArray, HoldsEveryReplicatedSampleOfEveryTileSize) {
  for (const ImageSize image : {ImageSize{1, 1}, {16, 16}, {17, 31}, {65, 200}}) {
    for (const TileGrid& grid : {TileGrid::squares(image, 16), TileGrid::rows_of(image)}) {
      SampleArray array = whole(grid);
      for (const Quantum& quantum : all_quanta(grid)) ASSERT_TRUE(place(array, quantum));
      EXPECT_EQ(array.step(), kPixelStep);
    }
  }
}

}  // namespace
}  // namespace goldthread
