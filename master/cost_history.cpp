// SPDX-License-Identifier: Apache-2.0
#include "master/cost_history.h"

namespace goldthread {

void CostHistory::fit(const TileGrid& grid) {
  if (grid == grid_) return;
  grid_ = grid;
  us_per_ray_.assign(grid.count(), -1);
  known_ = 0;
  known_sum_ = 0;
}

void CostHistory::record(TileId tile, std::uint64_t rays, std::chrono::microseconds cost) {
  if (tile.value >= us_per_ray_.size() || rays == 0) return;
  double& entry = us_per_ray_[tile.value];
  if (entry < 0)
    ++known_;
  else
    known_sum_ -= entry;
  entry = static_cast<double>(cost.count()) / static_cast<double>(rays);
  known_sum_ += entry;
}

double CostHistory::predict_us(TileId tile, std::uint64_t rays) const {
  if (known_ == 0 || tile.value >= us_per_ray_.size()) return 0;
  const double own = us_per_ray_[tile.value];
  const double per_ray = own >= 0 ? own : known_sum_ / static_cast<double>(known_);
  return per_ray * static_cast<double>(rays);
}

}  // namespace goldthread
