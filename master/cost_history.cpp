// SPDX-License-Identifier: Apache-2.0
#include "master/cost_history.h"

#include <algorithm>

namespace goldthread {

void CostHistory::fit(const TileGrid& grid) {
  if (grid == grid_) return;
  if (grid.image != grid_.image) steps_.clear();
  grid_ = grid;
  rects_ = grid.rects();
}

void CostHistory::record(TileId tile, Step step, std::chrono::microseconds cost) {
  if (tile.value >= rects_.size() || step == kNoStep) return;
  const std::size_t place = std::min(step, kLastForeseen).value;
  if (steps_.size() < place) steps_.resize(place, CostImage(grid_.image));
  steps_[place - 1].record(rects_[tile.value], double(cost.count()));
}

void CostHistory::reproject(const Camera& older, const Camera& newer,
                            std::span<const glm::dvec3> points_mm) {
  if (older == newer || empty()) return;
  const Warp warp = warp_of(grid_.image, older, newer, points_mm);
  for (CostImage& step : steps_) step.warp(warp);
}

double CostHistory::step_us(const PixelRect& rect, Step step) const {
  for (std::size_t i = std::min<std::size_t>(step.value, steps_.size()); i-- > 0;)
    if (!steps_[i].empty()) return steps_[i].predict_us(rect);
  return 0;
}

double CostHistory::predict_us(TileId tile, Step step) const {
  return tile.value < rects_.size() ? step_us(rects_[tile.value], step) : 0;
}

double CostHistory::predict_all_us(TileId tile, Step step) const {
  return tile.value < rects_.size() ? predict_area_us(rects_[tile.value], step) : 0;
}

double CostHistory::predict_area_us(const PixelRect& rect, Step step) const {
  double sum = 0;
  for (Step at{1}; at <= step; at = at.next()) sum += step_us(rect, at);
  return sum;
}

}  // namespace goldthread
