// SPDX-License-Identifier: Apache-2.0
#pragma once
// The project's own scheduler as the simulation drives it, and nothing else of the master: what is
// known beforehand is what the tiles cost in the frame before.

#include <cstdint>
#include <optional>
#include <vector>

#include "bench/scale/cost_image.h"
#include "master/scheduler.h"

namespace goldthread::bench {

class Scheduling {
 public:
  /// Deals `tiles` of the view, all of them in ascending order or a part, to workers 0 … workers−1.
  Scheduling(const FrameWork& before, std::vector<std::uint32_t> tiles, int workers, int capacity);

  /// Opens the first step, or the next one.
  void open();
  /// The tile that `worker` is to take through the open step, if it has room and there is one.
  std::optional<std::uint32_t> next(int worker);
  /// `worker` has done so, at this cost.
  void done(int worker, std::uint32_t tile, const StepCost& cost);
  bool finished() const { return scheduler_.finished(); }
  std::size_t tiles() const { return tiles_.size(); }

 private:
  std::vector<std::uint32_t> tiles_;  ///< by the scheduler's number
  TileGrid grid_;
  CostHistory costs_;
  Scheduler scheduler_;
};

}  // namespace goldthread::bench
