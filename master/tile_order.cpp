// SPDX-License-Identifier: Apache-2.0
#include "master/tile_order.h"

#include <algorithm>
#include <limits>

namespace goldthread {
namespace {

/// A stub predicts nothing, but says so: all tiles are the same, and none changes hands.
constexpr double kOneUs = 1;
constexpr double kNeverElsewhere = std::numeric_limits<double>::infinity();

}  // namespace

std::vector<TileTurn> dearest_first(Step step, std::span<const double> squared_errors,
                                    const CostHistory& costs) {
  std::vector<TileTurn> turns(squared_errors.size());
  std::vector<double> urgency(turns.size());
  for (std::uint32_t i = 0; i < turns.size(); ++i) {
    TileTurn& turn = turns[i];
    turn = {{i}, costs.predict_us({i}, step), costs.predict_all_us({i}, step), -1};
    // Errors are sums over the tile: its area is in them.
    urgency[i] = step == Step{1} ? turn.cost_us : squared_errors[i] / std::max(turn.cost_us, 1.0);
  }
  std::stable_sort(turns.begin(), turns.end(), [&](const TileTurn& a, const TileTurn& b) {
    return urgency[a.tile.value] > urgency[b.tile.value];
  });
  return turns;
}

TileOrder screen_order(int workers) {
  return [workers](Step, std::span<const double> squared_errors, const CostHistory&) {
    std::vector<TileTurn> turns(squared_errors.size());
    for (std::uint32_t i = 0; i < turns.size(); ++i)
      turns[i] = {{i}, kOneUs, kNeverElsewhere, static_cast<int>(i % std::uint32_t(workers))};
    return turns;
  };
}

}  // namespace goldthread
