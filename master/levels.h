// SPDX-License-Identifier: Apache-2.0
#pragma once
// Through which levels a view is taken.

#include <vector>

#include "common/tile/tile_grid.h"

namespace goldthread {

/// From the coarsest to the pixel level, for a view that is watched while it becomes finer.
inline std::vector<Level> progressive_levels() {
  std::vector<Level> levels;
  for (Level level = kCoarsestLevel;; level = level.finer()) {
    levels.push_back(level);
    if (level == kPixelLevel) return levels;
  }
}

/// To the pixel level at once, where only the finished picture counts.
inline std::vector<Level> direct_levels() { return {kPixelLevel}; }

}  // namespace goldthread
