// SPDX-License-Identifier: Apache-2.0
// Tiles that go out together, and the orders and shares that benches compare.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "master/scheduler.h"

namespace goldthread {
namespace {

constexpr Step kFirst{1};
using Tiles = std::vector<std::uint32_t>;

TileGrid row_of(int tiles) { return TileGrid::squares({64 * tiles, 64}, 64); }

CostHistory history(const TileGrid& grid, const std::vector<int>& costs, int steps = 1) {
  CostHistory result;
  result.fit(grid);
  for (Step step{1}; step.value <= steps; step = step.next())
    for (std::uint32_t i = 0; i < costs.size(); ++i)
      result.record({i}, step, std::chrono::microseconds(costs[i]));
  return result;
}

/// The tiles of the next quantum.
Tiles quantum(Scheduler& scheduler, int worker) {
  Tiles tiles;
  if (const auto first = scheduler.next(worker)) tiles.push_back(first->tile.value);
  while (const auto tile = scheduler.join(worker)) tiles.push_back(tile->value);
  return tiles;
}

void finish(Scheduler& scheduler, int worker, const Tiles& tiles) {
  for (const std::uint32_t tile : tiles)
    ASSERT_EQ(scheduler.done(worker, {tile}, scheduler.step(), 1), Finished::kFirst) << tile;
}

/// All quanta of a step, given to the workers in turn.
std::vector<Tiles> work_off(Scheduler& scheduler, int workers) {
  std::vector<Tiles> by_worker(std::size_t(workers), Tiles{});
  for (bool any = true; any;) {
    any = false;
    for (int w = 0; w < workers; ++w) {
      const Tiles tiles = quantum(scheduler, w);
      finish(scheduler, w, tiles);
      by_worker[std::size_t(w)].insert(by_worker[std::size_t(w)].end(), tiles.begin(), tiles.end());
      any = any || !tiles.empty();
    }
  }
  return by_worker;
}

TEST(SchedulerJoin, PutsCheapTilesTogetherUpToThreeHundredMicroseconds) {
  // So much in all that the share of a thread is no bound.
  std::vector<int> costs(300, 1000);
  for (std::size_t i = 0; i < 10; ++i) costs[i] = 90;
  const TileGrid grid = row_of(300);
  Scheduler scheduler({2});
  scheduler.begin_view(grid, history(grid, costs));
  std::vector<Tiles> quanta;
  while (!scheduler.finished()) {
    quanta.push_back(quantum(scheduler, 0));
    finish(scheduler, 0, quanta.back());
  }
  ASSERT_EQ(quanta.size(), 294u) << "each dear one alone";
  quanta.erase(quanta.begin(), quanta.begin() + 290);
  EXPECT_EQ(quanta, (std::vector<Tiles>{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {9}}));
}

TEST(SchedulerJoin, MakesNoQuantumThatTheOthersWouldWaitFor) {
  // 100 tiles of 10 µs for four threads: 250 µs each, a 64th of which is less than two tiles.
  const TileGrid grid = row_of(100);
  Scheduler scheduler({2, 2, 2, 2});
  scheduler.begin_view(grid, history(grid, std::vector(100, 10)));
  EXPECT_EQ(quantum(scheduler, 0), (Tiles{0}));
  // And 2000 of them: 5000 µs each, a 64th of which is seven tiles.
  const TileGrid many = TileGrid::squares({16 * 100, 16 * 20}, 16);
  scheduler.begin_view(many, history(many, std::vector(2000, 10)));
  EXPECT_EQ(quantum(scheduler, 0).size(), 7u);
}

TEST(SchedulerJoin, JoinsAtMostSixteenAndNothingThatIsUnknown) {
  std::vector<int> costs(100, 0);
  costs[0] = 100000;
  const TileGrid grid = row_of(100);
  Scheduler scheduler({10});
  scheduler.begin_view(grid, history(grid, costs));
  EXPECT_EQ(quantum(scheduler, 0), (Tiles{0}));
  EXPECT_EQ(quantum(scheduler, 0).size(), 16u);
  scheduler.begin_view(grid, {});
  EXPECT_EQ(quantum(scheduler, 0), (Tiles{0})) << "nothing is known";
  EXPECT_EQ(quantum(scheduler, 0), (Tiles{1}));
}

TEST(SchedulerJoin, CountsAQuantumAsOneUntilAllItsTilesAreDone) {
  std::vector<int> costs(40, 10);
  costs[0] = 100000;
  const TileGrid grid = row_of(40);
  Scheduler scheduler({2});
  scheduler.begin_view(grid, history(grid, costs));
  ASSERT_EQ(quantum(scheduler, 0), (Tiles{0}));
  const Tiles joined = quantum(scheduler, 0);
  ASSERT_EQ(joined.size(), 16u);
  for (std::size_t i = 0; i < joined.size(); ++i) {
    EXPECT_FALSE(scheduler.next(0)) << i;
    EXPECT_EQ(scheduler.done(0, {joined[i]}, kFirst, 1), Finished::kFirst);
    EXPECT_EQ(scheduler.done(0, {joined[i]}, kFirst, 1), Finished::kNot) << "a second time";
  }
  EXPECT_TRUE(scheduler.next(0));
}

TEST(SchedulerJoin, GivesAllTilesOfALostWorkersQuantaOutAgain) {
  std::vector<int> costs(40, 10);
  costs[0] = 100000;
  const TileGrid grid = row_of(40);
  Scheduler scheduler({2, 2});
  scheduler.begin_view(grid, history(grid, costs));
  const Tiles first = quantum(scheduler, 0), second = quantum(scheduler, 0);
  ASSERT_GT(second.size(), 1u);
  scheduler.worker_lost(0);
  EXPECT_FALSE(scheduler.join(0));
  Tiles again;
  while (const auto next = scheduler.next(1)) {
    again.push_back(next->tile.value);
    EXPECT_EQ(scheduler.done(1, next->tile, kFirst, 1), Finished::kFirst);
  }
  Tiles expected = first;
  expected.insert(expected.end(), second.begin(), second.end());
  ASSERT_EQ(again.size(), 40u);
  again.resize(expected.size());
  EXPECT_EQ(again, expected);
}

TEST(SchedulerJoin, LeavesTilesWithTheirOwner) {
  const TileGrid grid = TileGrid::squares({16 * 100, 16 * 20}, 16);
  const CostHistory costs = history(grid, std::vector(2000, 10), 2);
  Scheduler scheduler({2, 2});
  scheduler.begin_view(grid, costs);
  const auto first = work_off(scheduler, 2);
  ASSERT_TRUE(scheduler.finished());
  scheduler.open_step(costs);
  const Tiles mine(first[0].begin(), first[0].end());
  const std::set<std::uint32_t> own(mine.begin(), mine.end());
  for (const std::uint32_t tile : quantum(scheduler, 0)) EXPECT_TRUE(own.contains(tile)) << tile;
}

TEST(SchedulerStrategy, InScreenOrderCostDoesNotMatter) {
  std::mt19937 random(3);
  const TileGrid grid = row_of(50);
  std::vector<int> costs(50);
  for (int& cost : costs) cost = std::uniform_int_distribution(1, 1000)(random);
  Scheduler scheduler({2}, {Order::kScreen});
  scheduler.begin_view(grid, history(grid, costs, 2));
  for (int step = 0; step < 2; ++step) {
    for (std::uint32_t i = 0; i < 50; ++i) {
      ASSERT_EQ(scheduler.next(0)->tile, TileId{i});
      ASSERT_EQ(scheduler.done(0, {i}, scheduler.step(), 1000 - i % 7), Finished::kFirst);
    }
    scheduler.open_step(history(grid, costs, 2));
  }
}

TEST(SchedulerStrategy, InScreenOrderNothingIsJoinedAndNoSpareHeldBack) {
  const TileGrid grid = TileGrid::squares({16 * 100, 16 * 20}, 16);
  Scheduler scheduler({2}, {Order::kScreen});
  scheduler.begin_view(grid, history(grid, std::vector(2000, 10)));
  EXPECT_EQ(quantum(scheduler, 0), (Tiles{0}));
  Scheduler few({2, 2}, {Order::kScreen});
  few.begin_view(row_of(2), history(row_of(2), {5000, 5000}));
  EXPECT_EQ(quantum(few, 0), (Tiles{0}));
  EXPECT_EQ(quantum(few, 0), (Tiles{1}));
}

TEST(SchedulerStrategy, ShareAlikeIsByNumberOfTilesAndNobodyTakesOver) {
  const TileGrid grid = row_of(10);
  const CostHistory costs = history(grid, {1, 1, 1, 1, 1, 1, 1, 1, 1, 100000}, 3);
  const std::map<Share, std::vector<Tiles>> expected{
      {Share::kContiguous, {{0, 1, 2, 3}, {4, 5, 6}, {7, 8, 9}}},
      {Share::kInterleaved, {{0, 3, 6, 9}, {1, 4, 7}, {2, 5, 8}}}};
  for (const auto& [share, shares] : expected) {
    Scheduler scheduler({9, 9, 9}, {Order::kScreen, share});
    scheduler.begin_view(grid, costs);
    for (int step = 0; step < 3; ++step) {
      for (int w = 0; w < 3; ++w) {
        Tiles tiles;
        while (const auto next = scheduler.next(w)) tiles.push_back(next->tile.value);
        EXPECT_EQ(tiles, shares[std::size_t(w)]);
        finish(scheduler, w, tiles);
        EXPECT_FALSE(scheduler.next(w)) << "though others have work";
      }
      ASSERT_TRUE(scheduler.finished());
      scheduler.open_step(costs);
    }
  }
}

TEST(SchedulerStrategy, ALostWorkersShareIsTakenByTheOthers) {
  Scheduler scheduler({9, 9, 9}, {Order::kScreen, Share::kInterleaved});
  scheduler.begin_view(row_of(6), {});
  scheduler.worker_lost(1);
  EXPECT_EQ(quantum(scheduler, 0), (Tiles{0}));
  EXPECT_EQ(quantum(scheduler, 0), (Tiles{3}));
  EXPECT_EQ(quantum(scheduler, 0), (Tiles{1})) << "its own came first";
  scheduler.begin_view(row_of(6), {});
  EXPECT_EQ(work_off(scheduler, 3), (std::vector<Tiles>{{0, 2, 4}, {}, {1, 3, 5}}));
}

}  // namespace
}  // namespace goldthread
