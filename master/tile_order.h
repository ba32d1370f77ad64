// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the master computes of a step before it hands out its tiles: in which order they go, and
// what they will cost. Pure.

#include <functional>
#include <span>
#include <vector>

#include "common/base/types.h"
#include "common/tile/refinement.h"
#include "master/cost_history.h"

namespace goldthread {

struct TileTurn {
  TileId tile;
  double cost_us = 0;      ///< predicted, of the step; 0: unknown
  double all_cost_us = 0;  ///< of this and all earlier steps
  int worker = -1;  ///< that is to have it, where none holds its state; −1: who comes first
};

/// All tiles once, those that go out first in front. `squared_errors`, by tile, are sums over a
/// tile's pixels after the step before.
using TileOrder = std::function<std::vector<TileTurn>(
    Step step, std::span<const double> squared_errors, const CostHistory& costs)>;

/// At the first step by descending predicted cost, after it by descending error × area / cost.
std::vector<TileTurn> dearest_first(Step step, std::span<const double> squared_errors,
                                    const CostHistory& costs);

/// By-passes that (State et al. 1995): tiles as they lie on the screen, one for each worker in
/// turn, all of the same cost, next to none; none changes hands unless its worker is lost.
TileOrder screen_order(int workers);

}  // namespace goldthread
