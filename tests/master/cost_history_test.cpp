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

TEST(CostHistory, IsForgottenWithItsGridAndKeptWithTheSame) {
  CostHistory history = fitted();
  history.record({1}, kFirst, microseconds(7));
  history.fit(kGrid);
  EXPECT_EQ(history.predict_us({1}, kFirst), 7);
  history.fit(TileGrid::squares({256, 256}, 32));
  EXPECT_TRUE(history.empty());
  EXPECT_EQ(history.predict_us({1}, kFirst), 0);
  history.fit(kGrid);
  EXPECT_TRUE(history.empty()) << "what was forgotten does not come back";
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
