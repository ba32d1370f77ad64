// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/deal_chunks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace goldthread::bench {
namespace {

FrameWork random_work(int tiles, int steps) {
  std::mt19937 random(5);
  FrameWork work{TileGrid::squares({64 * tiles, 64}, 64), {}};
  for (int step = 0; step < steps; ++step) {
    auto& costs = work.steps.emplace_back();
    for (int tile = 0; tile < tiles; ++tile)
      costs.push_back({std::uniform_real_distribution<double>(1, 100)(random), 0, 0});
  }
  return work;
}

TEST(DealChunks, EachTileIsDealtOnceAndChunksStayTogether) {
  const FrameWork work = random_work(103, 2);
  const auto parts = deal_chunks(work, 4, 5);
  ASSERT_EQ(parts.size(), 4U);
  std::set<std::uint32_t> seen;
  for (const auto& part : parts) {
    EXPECT_TRUE(std::is_sorted(part.begin(), part.end()));
    for (const std::uint32_t tile : part) {
      EXPECT_TRUE(seen.insert(tile).second);
      const std::uint32_t first = tile / 5 * 5;
      EXPECT_TRUE(std::binary_search(part.begin(), part.end(), first));
    }
  }
  EXPECT_EQ(seen.size(), 103U);
}

TEST(DealChunks, LoadsDifferByAChunkAtMost) {
  const FrameWork work = random_work(400, 3);
  double dearest = 0;
  std::vector<double> loads;
  for (const auto& part : deal_chunks(work, 7, 1)) {
    double load = 0;
    for (const std::uint32_t tile : part) {
      double cost = 0;
      for (const auto& step : work.steps) cost += step[tile].us;
      dearest = std::max(dearest, cost);
      load += cost;
    }
    loads.push_back(load);
  }
  const auto [least, most] = std::minmax_element(loads.begin(), loads.end());
  EXPECT_LE(*most - *least, dearest);
}

TEST(DealChunks, FewerChunksThanMastersLeaveSomeWithout) {
  const auto parts = deal_chunks(random_work(3, 1), 8, 2);
  EXPECT_EQ(std::count_if(parts.begin(), parts.end(), [](const auto& p) { return !p.empty(); }), 2);
}

}  // namespace
}  // namespace goldthread::bench
