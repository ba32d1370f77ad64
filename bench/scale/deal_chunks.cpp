// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/deal_chunks.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>
#include <utility>

namespace goldthread::bench {

std::vector<std::vector<std::uint32_t>> deal_chunks(const FrameWork& predicted, int masters,
                                                    int tiles_per_chunk) {
  const auto tiles = predicted.grid.count();
  const auto length = static_cast<std::uint32_t>(tiles_per_chunk);
  std::vector<double> cost((tiles + length - 1) / length);
  for (const std::vector<StepCost>& step : predicted.steps)
    for (std::uint32_t tile = 0; tile < tiles; ++tile) cost[tile / length] += step[tile].us;
  std::vector<std::uint32_t> order(cost.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return cost[a] > cost[b]; });

  using Load = std::pair<double, std::size_t>;
  std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
  for (std::size_t master = 0; master < std::size_t(masters); ++master) loads.emplace(0, master);
  std::vector<std::vector<std::uint32_t>> parts(std::size_t(masters), std::vector<std::uint32_t>{});
  for (const std::uint32_t chunk : order) {
    const auto [load, master] = loads.top();
    loads.pop();
    for (std::uint32_t i = chunk * length; i < std::min(tiles, (chunk + 1) * length); ++i)
      parts[master].push_back(i);
    loads.emplace(load + cost[chunk], master);
  }
  for (std::vector<std::uint32_t>& part : parts) std::sort(part.begin(), part.end());
  return parts;
}

}  // namespace goldthread::bench
