// SPDX-License-Identifier: Apache-2.0
#pragma once
// What each step of each tile cost in the last frame, and what it will therefore cost in the next:
// VOL2's observation that the last frame is the best predictor. Pure.

#include <chrono>
#include <cstdint>
#include <vector>

#include "common/tile/refinement.h"
#include "common/tile/tile_grid.h"

namespace goldthread {

class CostHistory {
 public:
  /// Forgets what does not fit the grid: another grid starts from nothing.
  void fit(const TileGrid& grid);
  /// Taking `tile` to `step` from the one before took `cost`.
  void record(TileId tile, Step step, std::chrono::microseconds cost);
  /// The predicted cost of a step, in µs: the tile's own, that of the tiles that are known, or of
  /// the step before; 0 where nothing is known.
  double predict_us(TileId tile, Step step) const;
  /// All steps of a tile up to this one.
  double predict_all_us(TileId tile, Step step) const;
  /// Whether anything is known.
  bool empty() const { return steps_.empty(); }

 private:
  struct StepCosts {
    std::vector<float> us;  ///< by tile; negative: never taken
    std::size_t known = 0;
    double known_sum = 0;
  };

  TileGrid grid_;
  std::vector<StepCosts> steps_;  ///< the first is of step 1
};

}  // namespace goldthread
