// SPDX-License-Identifier: Apache-2.0
#include "master/tile_order.h"

#include <gtest/gtest.h>

#include "master/scheduler.h"

namespace goldthread {
namespace {

const TileGrid kGrid = TileGrid::squares({64 * 5, 64 * 3}, 64);

std::vector<std::uint32_t> taken_by(Scheduler& scheduler, int worker) {
  std::vector<std::uint32_t> tiles;
  while (const auto quantum = scheduler.next(worker)) {
    tiles.push_back(quantum->tile.value);
    scheduler.done(worker, quantum->tile, scheduler.step(), 1);
  }
  return tiles;
}

TEST(ScreenOrder, DealsTilesOutInTurnAsTheyLieAtEachStep) {
  Scheduler scheduler({2, 2, 2}, screen_order(3));
  CostHistory costs;
  costs.fit(kGrid);
  // What tiles cost is nothing that a stub looks at.
  for (std::uint32_t i = 0; i < kGrid.count(); ++i)
    costs.record({i}, {1}, std::chrono::microseconds(1000 * i));
  scheduler.begin_view(kGrid, costs);
  for (int step = 0; step < 2; ++step) {
    if (step > 0) scheduler.open_step(costs);
    for (int worker : {2, 0, 1}) {
      const auto tiles = taken_by(scheduler, worker);
      ASSERT_EQ(tiles.size(), 5u);
      for (std::size_t i = 0; i < tiles.size(); ++i)
        EXPECT_EQ(tiles[i], 3 * i + std::size_t(worker));
    }
    EXPECT_TRUE(scheduler.finished());
  }
}

TEST(ScreenOrder, TilesOfALostWorkerGoToTheOthers) {
  Scheduler scheduler({2, 2, 2}, screen_order(3));
  scheduler.begin_view(kGrid, {});
  scheduler.worker_lost(1);
  EXPECT_EQ(taken_by(scheduler, 0).size() + taken_by(scheduler, 2).size(), kGrid.count());
  EXPECT_TRUE(scheduler.finished());
  scheduler.begin_view(kGrid, {});
  EXPECT_EQ(taken_by(scheduler, 0).size() + taken_by(scheduler, 2).size(), kGrid.count());
}

/// All tiles took so long in the last frame.
CostHistory all_cost(std::chrono::microseconds cost) {
  CostHistory costs;
  costs.fit(kGrid);
  for (std::uint32_t i = 0; i < kGrid.count(); ++i) costs.record({i}, {1}, cost);
  return costs;
}

std::size_t held_by_one(const CostHistory& costs, double spare_us) {
  Scheduler scheduler({3}, dearest_first, spare_us);
  scheduler.begin_view(kGrid, costs);
  std::size_t held = 0;
  while (scheduler.next(0)) ++held;
  return held;
}

TEST(Scheduler, AWorkerOfQuickTilesHoldsAsManyAsTakeItsSpareTime) {
  // Two threads of 500 µs each: tiles of 100 µs until 1000 µs are in hand.
  EXPECT_EQ(held_by_one(all_cost(std::chrono::microseconds(100)), 500), 10u);
  EXPECT_EQ(held_by_one(all_cost(std::chrono::microseconds(300)), 500), 4u);
  EXPECT_EQ(held_by_one(all_cost(std::chrono::microseconds(1)), 500), kGrid.count());
}

TEST(Scheduler, AWorkerHoldsNoMoreThanItsCapacityOfSlowOrUnknownTiles) {
  EXPECT_EQ(held_by_one(all_cost(std::chrono::microseconds(5000)), 500), 3u);
  EXPECT_EQ(held_by_one({}, 500), 3u);
  EXPECT_EQ(held_by_one(all_cost(std::chrono::microseconds(1)), 0), 3u);
}

TEST(Scheduler, SpareTimeIsFreeAgainWhenATileIsDone) {
  Scheduler scheduler({3}, dearest_first, 500);
  scheduler.begin_view(kGrid, all_cost(std::chrono::microseconds(100)));
  std::vector<TileId> held;
  while (const auto quantum = scheduler.next(0)) held.push_back(quantum->tile);
  ASSERT_EQ(held.size(), 10u);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(scheduler.done(0, held[std::size_t(i)], {1}, 1), Finished::kFirst);
    EXPECT_TRUE(scheduler.next(0));
    EXPECT_FALSE(scheduler.next(0));
  }
}

}  // namespace
}  // namespace goldthread
