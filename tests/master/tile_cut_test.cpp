// SPDX-License-Identifier: Apache-2.0
#include "master/tile_cut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace goldthread {
namespace {

constexpr Step kFirst{1};
constexpr ImageSize kImage{512, 512};

/// Each block of 16×16 pixels costs what `us` says of its column and row.
template <class F>
CostHistory blocks(F us) {
  const TileGrid grid = TileGrid::squares(kImage, 16);
  CostHistory history;
  history.fit(grid);
  for (std::uint32_t i = 0; i < grid.count(); ++i)
    history.record({i}, kFirst, std::chrono::microseconds(us(int(i) % 32, int(i) / 32)));
  return history;
}

TEST(RootEdge, GivesEachThreadSixteenTiles) {
  EXPECT_EQ(root_edge(kImage, 1), 64);
  EXPECT_EQ(root_edge(kImage, 4), 64);
  EXPECT_EQ(root_edge(kImage, 5), 32);
  EXPECT_EQ(root_edge(kImage, 16), 32);
  EXPECT_EQ(root_edge(kImage, 17), 16);
  EXPECT_EQ(root_edge(kImage, 4096), 16) << "there are none smaller";
  EXPECT_EQ(root_edge({1, 1}, 1), 16);
  EXPECT_EQ(root_edge({1920, 1080}, 31), 64);
  EXPECT_EQ(root_edge({1920, 1080}, 32), 32);
}

TEST(SplitDear, LeavesAnEvenPictureAndOneThatNothingIsKnownOf) {
  const TileGrid grid = TileGrid::squares(kImage, 64);
  EXPECT_EQ(split_dear(grid, {}, kFirst, 4), grid);
  EXPECT_EQ(split_dear(grid, blocks([](int, int) { return 0; }), kFirst, 4), grid);
  EXPECT_EQ(split_dear(grid, blocks([](int, int) { return 100; }), kFirst, 4), grid);
}

TEST(SplitDear, SplitsWhatIsDearAsFarAsItIs) {
  // All the cost is in the block at column 5, row 6, which is in root 9's quarter 2.
  const auto history = blocks([](int x, int y) { return x == 5 && y == 6 ? 10000 : 0; });
  const TileGrid cut = split_dear(TileGrid::squares(kImage, 64), history, kFirst, 4);
  ASSERT_EQ(cut.splits.size(), 1u);
  EXPECT_EQ(cut.splits[0], (SplitRoot{9, 0b0100}));
  EXPECT_TRUE(cut.valid());
}

TEST(SplitDear, SplitsAtFourTenthsOfAWorkersShare) {
  // A root of 4000 µs among others of 6000 µs in all: dear to more than one thread.
  const auto history = blocks([](int x, int y) {
    if (x < 4 && y < 4) return 250;
    return x == 20 && y < 30 ? 200 : 0;
  });
  const TileGrid grid = TileGrid::squares(kImage, 64);
  EXPECT_TRUE(split_dear(grid, history, kFirst, 1).splits.empty()) << "4000 of 4000";
  const TileGrid cut = split_dear(grid, history, kFirst, 2);
  ASSERT_EQ(cut.splits.size(), 1u) << "4000 of 2000";
  EXPECT_EQ(cut.splits[0], (SplitRoot{0, 0})) << "quarters of 1000";
  EXPECT_EQ(split_dear(grid, history, kFirst, 5).splits[0], (SplitRoot{0, 15})) << "of 800";
}

TEST(SplitDear, LeavesNothingDearThatCouldBeSplit) {
  std::mt19937 random(1);
  for (const int threads : {2, 3, 8, 40}) {
    const auto history = blocks([&](int, int) {
      const int dice = std::uniform_int_distribution(0, 99)(random);
      return dice < 95 ? dice : 1000 * dice;
    });
    const TileGrid cut = split_dear(TileGrid::squares(kImage, 64), history, kFirst, threads);
    ASSERT_TRUE(cut.valid());
    double total = 0;
    for (const PixelRect& rect : cut.rects()) total += history.predict_area_us(rect, kFirst);
    for (const PixelRect& rect : cut.rects()) {
      if (rect.width == 16) continue;
      EXPECT_LE(history.predict_area_us(rect, kFirst), kDearShare * total / threads);
    }
  }
}

TEST(SplitDear, LeavesClippedRootsWhole) {
  const TileGrid grid = TileGrid::squares({100, 70}, 64);
  CostHistory history;
  history.fit(grid);
  for (std::uint32_t i = 0; i < 4; ++i)
    history.record({i}, kFirst, std::chrono::microseconds(i == 1 ? 1000 : 1));
  const TileGrid cut = split_dear(grid, history, kFirst, 8);
  EXPECT_TRUE(cut.splits.empty());
}

TEST(SplitDear, KeepsASplitUntilItsRootIsCheap) {
  const auto history_of = [](int us) {
    return blocks([us](int x, int y) {
      if (x < 4 && y < 4) return us;
      return x == 20 && y < 30 ? 200 : 0;
    });
  };
  const TileGrid whole = TileGrid::squares(kImage, 64);
  const TileGrid split = split_dear(whole, history_of(250), kFirst, 2);
  ASSERT_FALSE(split.splits.empty());
  // 16 × 80 = 1280 of 7280 µs: dear are 1456, and half of that is less.
  EXPECT_TRUE(split_dear(whole, history_of(80), kFirst, 2).splits.empty());
  EXPECT_EQ(split_dear(split, history_of(80), kFirst, 2), split);
  EXPECT_EQ(split_dear(split, history_of(30), kFirst, 2), whole) << "480 of 6480 µs";
}

TEST(CutOf, LeavesPicturesWhoseSamplesAreChosenAloneWithWorkers) {
  for (const Sampling sampling : {Sampling::kAdaptive, Sampling::kSubdivision}) {
    for (const int threads : {1, 1000}) {
      const ViewCut cut = cut_of({}, kImage, sampling, Update::kAll, threads);
      EXPECT_EQ(cut.grid, TileGrid::squares(kImage, 64));
      EXPECT_FALSE(cut.split);
    }
  }
}

TEST(CutOf, CutsByThreadsWhereEachPixelIsCast) {
  const ViewCut every = cut_of({}, kImage, Sampling::kEveryPixel, Update::kAll, 8);
  EXPECT_EQ(every.grid, TileGrid::squares(kImage, 32));
  EXPECT_TRUE(every.split);
  const ViewCut moving = cut_of({}, kImage, Sampling::kAdaptive, Update::kWhole, 8);
  EXPECT_EQ(moving.grid, every.grid);
  EXPECT_TRUE(moving.split);
}

TEST(CutOf, DoesNotSplitWhereSamplesOfOlderFramesAreKept) {
  for (const Update update : {Update::kHalf, Update::kQuarter, Update::kFrameless}) {
    const ViewCut cut = cut_of({}, kImage, Sampling::kAdaptive, update, 8);
    EXPECT_EQ(cut.grid, TileGrid::squares(kImage, 32));
    EXPECT_FALSE(cut.split);
  }
}

TEST(CutOf, DoesWhatTheUserChose) {
  for (const Update update : {Update::kAll, Update::kWhole}) {
    const ViewCut squares = cut_of({48, false}, kImage, Sampling::kEveryPixel, update, 8);
    EXPECT_EQ(squares.grid, TileGrid::squares(kImage, 48));
    EXPECT_FALSE(squares.split);
    const ViewCut rows = cut_of({48, true}, kImage, Sampling::kEveryPixel, update, 8);
    EXPECT_EQ(rows.grid, TileGrid::rows_of(kImage));
    EXPECT_FALSE(rows.split);
  }
}

}  // namespace
}  // namespace goldthread
