// SPDX-License-Identifier: Apache-2.0
#include "master/cost_history.h"

#include <gtest/gtest.h>

namespace goldthread {
namespace {

using std::chrono::microseconds;

const TileGrid kGrid = TileGrid::squares({256, 256}, 64);

CostHistory fitted(const TileGrid& grid = kGrid) {
  CostHistory history;
  history.fit(grid);
  return history;
}

TEST(CostHistory, KnowsNothingAtFirst) {
  EXPECT_TRUE(CostHistory().empty());
  EXPECT_EQ(CostHistory().predict_us({0}, 100), 0);
  EXPECT_TRUE(fitted().empty());
  EXPECT_EQ(fitted().predict_us({0}, 100), 0);
}

TEST(CostHistory, PredictsTheLastCostPerRay) {
  CostHistory history = fitted();
  history.record({3}, 10, microseconds(500));
  EXPECT_FALSE(history.empty());
  EXPECT_DOUBLE_EQ(history.predict_us({3}, 10), 500);
  EXPECT_DOUBLE_EQ(history.predict_us({3}, 4), 200);
  history.record({3}, 100, microseconds(100));
  EXPECT_DOUBLE_EQ(history.predict_us({3}, 10), 10) << "the last one alone";
}

TEST(CostHistory, PredictsTheMeanOfTheKnownForAnUnknownTile) {
  CostHistory history = fitted();
  history.record({0}, 1, microseconds(10));
  history.record({1}, 1, microseconds(30));
  EXPECT_DOUBLE_EQ(history.predict_us({2}, 1), 20);
  history.record({0}, 1, microseconds(50));
  EXPECT_DOUBLE_EQ(history.predict_us({2}, 3), 3 * 40) << "each tile counts once";
}

TEST(CostHistory, IsForgottenWithItsGridAndKeptWithTheSame) {
  CostHistory history = fitted();
  history.record({1}, 1, microseconds(7));
  history.fit(kGrid);
  EXPECT_DOUBLE_EQ(history.predict_us({1}, 1), 7);
  history.fit(TileGrid::squares({256, 256}, 32));
  EXPECT_TRUE(history.empty());
  EXPECT_EQ(history.predict_us({1}, 1), 0);
  history.fit(kGrid);
  EXPECT_TRUE(history.empty()) << "what was forgotten does not come back";
}

TEST(CostHistory, IgnoresNoRaysAndTilesOutsideItsGrid) {
  CostHistory history = fitted();
  history.record({0}, 0, microseconds(7));
  history.record({kGrid.count()}, 1, microseconds(7));
  EXPECT_TRUE(history.empty());
  EXPECT_EQ(history.predict_us({kGrid.count()}, 1), 0);
}

TEST(CostHistory, KnowsATileThatCostNothing) {
  CostHistory history = fitted();
  history.record({0}, 1, microseconds(0));
  history.record({1}, 1, microseconds(10));
  EXPECT_EQ(history.predict_us({0}, 1), 0);
  EXPECT_DOUBLE_EQ(history.predict_us({2}, 1), 5);
}

}  // namespace
}  // namespace goldthread
