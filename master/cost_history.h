// SPDX-License-Identifier: Apache-2.0
#pragma once
// What each step of each part of the picture cost in the last frame, and what it will therefore
// cost in the next: VOL2's observation that the last frame is the best predictor. Pure.

#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "common/tile/refinement.h"
#include "common/tile/tile_grid.h"
#include "master/cost_image.h"

namespace goldthread {

/// All steps from this one on count as one: refinement goes on for ever.
constexpr Step kLastForeseen{32};

class CostHistory {
 public:
  /// Tiles are those of this grid from now on. What is known stays so however the picture is cut;
  /// a picture of another size starts from nothing.
  void fit(const TileGrid& grid);
  /// Taking `tile` to `step` from the one before took `cost`.
  void record(TileId tile, Step step, std::chrono::microseconds cost);
  /// The next picture is seen from another camera: costs move with what is seen (warp_of).
  void reproject(const Camera& older, const Camera& newer, std::span<const glm::dvec3> points_mm);

  /// The predicted cost of a step, in µs: what is known of the place, the mean of what is known, or
  /// that of the step before; 0 where nothing is known.
  double predict_us(TileId tile, Step step) const;
  /// All steps of a tile up to this one.
  double predict_all_us(TileId tile, Step step) const;
  /// And of a rectangle of whole blocks (CostImage), whatever the grid.
  double predict_area_us(const PixelRect& rect, Step step) const;
  /// Whether anything is known.
  bool empty() const { return steps_.empty(); }
  /// The last step of which anything is known.
  Step last_step() const { return {static_cast<std::uint16_t>(steps_.size())}; }

 private:
  double step_us(const PixelRect& rect, Step step) const;

  TileGrid grid_;
  std::vector<PixelRect> rects_;  ///< of the grid's tiles
  std::vector<CostImage> steps_;  ///< the first is of step 1
};

}  // namespace goldthread
