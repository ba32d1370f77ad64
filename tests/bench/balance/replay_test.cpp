// SPDX-License-Identifier: Apache-2.0
#include "bench/balance/replay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace goldthread::bench {
namespace {

/// One row of tiles that took so many µs, for each step.
CastFrame frame_of(const std::vector<std::vector<double>>& steps) {
  CastFrame frame;
  frame.grid = TileGrid::squares({64 * int(steps[0].size()), 64}, 64);
  for (const auto& us : steps) frame.steps.push_back({us, std::vector(us.size(), 1.0)});
  return frame;
}

CostHistory exact(const CastFrame& frame) { return history_of(frame, frame.camera, {}); }

constexpr Strategy kInOrder{Order::kScreen}, kBlocks{Order::kScreen, Share::kContiguous},
    kDealt{Order::kScreen, Share::kInterleaved};

TEST(Replay, OfOneWorkerIsTheSumOfAllTiles) {
  const CastFrame frame = frame_of({{100, 200, 300, 4000}, {10, 20, 30, 40}});
  for (const Strategy strategy : {Strategy{}, kInOrder, kBlocks, kDealt}) {
    const Replayed replayed = replay(frame, exact(frame), 1, strategy);
    EXPECT_NEAR(replayed.seconds, 4700e-6, 1e-12);
    EXPECT_EQ(replayed.imbalance, 0);
  }
}

TEST(Replay, OfSharesIsTheirGreatestSum) {
  const CastFrame frame = frame_of({{100, 200, 300, 4000, 500, 600}});
  const Replayed blocks = replay(frame, exact(frame), 2, kBlocks);
  EXPECT_NEAR(blocks.seconds, 5100e-6, 1e-12);
  EXPECT_NEAR(blocks.imbalance, 5100 / (5700 / 2.0) - 1, 1e-12);
  const Replayed dealt = replay(frame, exact(frame), 2, kDealt);
  EXPECT_NEAR(dealt.seconds, 4800e-6, 1e-12);
  EXPECT_NEAR(dealt.imbalance, 4800 / (5700 / 2.0) - 1, 1e-12);
}

TEST(Replay, OnDemandInScreenOrderEndsWithADearLastTile) {
  // Two workers, each with a spare tile: tiles 0 and 2 go to the first, 1 and 3 to the second, the
  // last to whoever has room first.
  const CastFrame frame = frame_of({{1000, 2000, 1000, 1000, 6000}});
  const Replayed in_order = replay(frame, exact(frame), 2, kInOrder);
  EXPECT_NEAR(in_order.seconds, (1000 + 1000 + 6000) * 1e-6, 1e-12);
  EXPECT_NEAR(in_order.imbalance, 8000 / 5500.0 - 1, 1e-12);
  // By cost: 6000 | 2000, no spares, since they would wait, and all others to the second.
  const Replayed by_cost = replay(frame, exact(frame), 2, {});
  EXPECT_NEAR(by_cost.seconds, 6000e-6, 1e-12);
}

TEST(Replay, BeginsAStepWhenTheOneBeforeIsDone) {
  const CastFrame frame = frame_of({{1000, 3000}, {2000, 500}});
  // Tiles stay: 1000 and 3000, then 2000 and 500.
  const Replayed replayed = replay(frame, exact(frame), 2, kDealt);
  EXPECT_NEAR(replayed.seconds, 5000e-6, 1e-12);
  EXPECT_NEAR(replayed.imbalance, 3500 / 3250.0 - 1, 1e-12);
}

TEST(Replay, CountsTheEarlierStepsOfATileThatIsTakenOver) {
  // One worker casts the first step of all but one tile; then the other is idle in the second.
  std::vector<double> first(9, 10), second(9, 1000);
  first[0] = 80;
  const CastFrame frame = frame_of({first, second});
  const Replayed replayed = replay(frame, exact(frame), 2, {});
  double all = std::accumulate(first.begin(), first.end(), 0.0) + 9000;
  EXPECT_GT(replayed.seconds, all / 2 * 1e-6);
  // Without taking over the second step alone would be eight tiles of the one worker.
  EXPECT_LT(replayed.seconds, 7000e-6);
}

TEST(Replay, IsNeverBelowTheMeanOrTheDearestTileNorFarAboveThem) {
  std::mt19937 random(5);
  for (int run = 0; run < 50; ++run) {
    std::vector<double> us(64);
    for (double& each : us) each = std::uniform_int_distribution(1, 20000)(random);
    const CastFrame frame = frame_of({us});
    const int workers = std::uniform_int_distribution(2, 12)(random);
    const double sum = std::accumulate(us.begin(), us.end(), 0.0);
    const double dearest = *std::max_element(us.begin(), us.end());
    for (const Strategy strategy : {Strategy{}, kInOrder}) {
      const double seconds = replay(frame, exact(frame), workers, strategy).seconds;
      EXPECT_GE(seconds, 1e-6 * std::max(sum / workers, dearest) - 1e-12);
      // Graham's bound on list scheduling; a spare tile may wait for one more.
      EXPECT_LE(seconds, 1e-6 * (sum / workers + 2 * dearest) + 1e-12);
    }
  }
}

}  // namespace
}  // namespace goldthread::bench
