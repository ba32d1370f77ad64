// SPDX-License-Identifier: Apache-2.0
#include "master/cost_history.h"

#include <algorithm>

namespace goldthread {

void CostHistory::fit(const TileGrid& grid) {
  if (grid == grid_) return;
  grid_ = grid;
  steps_.clear();
}

void CostHistory::record(TileId tile, Step step, std::chrono::microseconds cost) {
  if (tile.value >= grid_.count() || step == kNoStep) return;
  if (steps_.size() < step.value) steps_.resize(step.value);
  StepCosts& costs = steps_[step.value - 1U];
  if (costs.us.empty()) costs.us.assign(grid_.count(), -1);
  float& entry = costs.us[tile.value];
  if (entry < 0)
    ++costs.known;
  else
    costs.known_sum -= double(entry);
  entry = static_cast<float>(cost.count());
  costs.known_sum += double(entry);
}

double CostHistory::predict_us(TileId tile, Step step) const {
  for (std::size_t i = std::min<std::size_t>(step.value, steps_.size()); i-- > 0;) {
    const StepCosts& costs = steps_[i];
    if (costs.known == 0 || tile.value >= costs.us.size()) continue;
    const double own = double(costs.us[tile.value]);
    return own >= 0 ? own : costs.known_sum / double(costs.known);
  }
  return 0;
}

double CostHistory::predict_all_us(TileId tile, Step step) const {
  double sum = 0;
  for (Step at{1}; at <= step; at = at.next()) sum += predict_us(tile, at);
  return sum;
}

}  // namespace goldthread
