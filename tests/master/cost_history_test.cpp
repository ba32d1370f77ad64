// SPDX-License-Identifier: Apache-2.0
#include "master/cost_history.h"

#include <gtest/gtest.h>

namespace goldthread {
namespace {

using std::chrono::microseconds;

const TileGrid kGrid = TileGrid::squares({256, 256}, 64);
constexpr Step kFirst{1}, kSecond{2}, kThird{3};

CostHistory fitted(const TileGrid& grid = kGrid) {
  CostHistory history;
  history.fit(grid);
  return history;
}

TEST(CostHistory, KnowsNothingAtFirst) {
  EXPECT_TRUE(CostHistory().empty());
  EXPECT_EQ(CostHistory().predict_us({0}, kThird), 0);
  EXPECT_TRUE(fitted().empty());
  EXPECT_EQ(fitted().predict_us({0}, kThird), 0);
  EXPECT_EQ(fitted().predict_all_us({0}, kThird), 0);
}

TEST(CostHistory, PredictsTheLastCostOfEachStep) {
  CostHistory history = fitted();
  history.record({3}, kFirst, microseconds(500));
  history.record({3}, kSecond, microseconds(80));
  EXPECT_FALSE(history.empty());
  EXPECT_EQ(history.predict_us({3}, kFirst), 500);
  EXPECT_EQ(history.predict_us({3}, kSecond), 80);
  history.record({3}, kFirst, microseconds(100));
  EXPECT_EQ(history.predict_us({3}, kFirst), 100) << "the last one alone";
  EXPECT_EQ(history.predict_us({3}, kSecond), 80);
}

TEST(CostHistory, PredictsTheMeanOfTheKnownForAnUnknownTile) {
  CostHistory history = fitted();
  history.record({0}, kSecond, microseconds(10));
  history.record({1}, kSecond, microseconds(30));
  EXPECT_EQ(history.predict_us({2}, kSecond), 20);
  history.record({0}, kSecond, microseconds(50));
  EXPECT_EQ(history.predict_us({2}, kSecond), 40) << "each tile counts once";
}

TEST(CostHistory, PredictsForAStepNeverTakenWhatTheOneBeforeCost) {
  CostHistory history = fitted();
  history.record({0}, kFirst, microseconds(10));
  history.record({0}, kSecond, microseconds(20));
  history.record({1}, kSecond, microseconds(40));
  EXPECT_EQ(history.predict_us({0}, {9}), 20);
  EXPECT_EQ(history.predict_us({2}, {9}), 30);
  EXPECT_EQ(history.predict_us({0}, kNoStep), 0);
}

TEST(CostHistory, DoesNotPredictAStepFromALaterOne) {
  CostHistory history = fitted();
  history.record({0}, kThird, microseconds(10));
  EXPECT_EQ(history.predict_us({0}, kSecond), 0);
  EXPECT_EQ(history.predict_us({0}, kThird), 10);
}

TEST(CostHistory, AddsUpAllStepsOfATile) {
  CostHistory history = fitted();
  history.record({0}, kFirst, microseconds(100));
  history.record({0}, kSecond, microseconds(20));
  history.record({1}, kThird, microseconds(3));
  EXPECT_EQ(history.predict_all_us({0}, kNoStep), 0);
  EXPECT_EQ(history.predict_all_us({0}, kFirst), 100);
  EXPECT_EQ(history.predict_all_us({0}, kSecond), 120);
  EXPECT_EQ(history.predict_all_us({0}, kThird), 123);
  EXPECT_EQ(history.predict_all_us({0}, {5}), 129);
}

TEST(CostHistory, OutlivesAnotherCutOfTheScreen) {
  CostHistory history = fitted();
  for (std::uint32_t i = 0; i < kGrid.count(); ++i)
    history.record({i}, kFirst, microseconds(i == 1 ? 64 : 16));
  TileGrid finer = TileGrid::squares(kGrid.image, 32);
  history.fit(finer);
  EXPECT_EQ(history.predict_us({0}, kFirst), 4);
  EXPECT_EQ(history.predict_us({2}, kFirst), 16) << "a quarter of tile 1";
  history.fit(TileGrid::rows_of(kGrid.image));
  EXPECT_EQ(history.predict_us({0}, kFirst), 4 + 16 + 4 + 4) << "a quarter of four tiles";
  TileGrid split = kGrid;
  split.splits = {{1, 0b0001}};
  history.fit(split);
  EXPECT_EQ(history.predict_us({0}, kFirst), 16);
  EXPECT_EQ(history.predict_us({1}, kFirst), 4);
  EXPECT_EQ(history.predict_us({5}, kFirst), 16);
  history.fit(kGrid);
  EXPECT_EQ(history.predict_us({1}, kFirst), 64);
}

TEST(CostHistory, IsForgottenWithTheSizeOfThePicture) {
  CostHistory history = fitted();
  history.record({1}, kFirst, microseconds(7));
  history.fit(TileGrid::squares({128, 256}, 64));
  EXPECT_TRUE(history.empty());
  EXPECT_EQ(history.predict_us({1}, kFirst), 0);
  history.fit(kGrid);
  EXPECT_TRUE(history.empty()) << "what was forgotten does not come back";
}

TEST(CostHistory, TakesAllLateStepsForOne) {
  CostHistory history = fitted();
  history.record({0}, {150}, microseconds(7));
  EXPECT_EQ(history.last_step(), kLastForeseen);
  EXPECT_EQ(history.predict_us({0}, {149}), 7);
  EXPECT_EQ(history.predict_us({0}, {31}), 0);
  history.record({0}, kLastStep, microseconds(9));
  EXPECT_EQ(history.predict_us({0}, {150}), 9);
}

TEST(CostHistory, ForeseesAnAreaOverAllSteps) {
  CostHistory history = fitted();
  history.record({0}, kFirst, microseconds(64));
  history.record({0}, kSecond, microseconds(128));
  EXPECT_EQ(history.last_step(), kSecond);
  EXPECT_EQ(history.predict_area_us({16, 32, 16, 16}, kFirst), 4);
  EXPECT_EQ(history.predict_area_us({16, 32, 16, 16}, kSecond), 12);
}

TEST(CostHistory, IgnoresNoStepAndTilesOutsideItsGrid) {
  CostHistory history = fitted();
  history.record({0}, kNoStep, microseconds(7));
  history.record({kGrid.count()}, kFirst, microseconds(7));
  EXPECT_TRUE(history.empty());
  history.record({0}, kFirst, microseconds(7));
  EXPECT_EQ(history.predict_us({kGrid.count()}, kFirst), 0);
}

TEST(CostHistory, KnowsATileThatCostNothing) {
  CostHistory history = fitted();
  history.record({0}, kFirst, microseconds(0));
  history.record({1}, kFirst, microseconds(10));
  EXPECT_EQ(history.predict_us({0}, kFirst), 0);
  EXPECT_EQ(history.predict_us({2}, kFirst), 5);
}

}  // namespace
}  // namespace goldthread
