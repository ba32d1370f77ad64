// SPDX-License-Identifier: Apache-2.0
#pragma once
// The project's own scheduler as the simulation drives it, and nothing else of the master: what is
// known beforehand is what the tiles cost in the frame before.

#include <cstdint>
#include <span>
#include <vector>

#include "bench/scale/cost_record.h"
#include "master/scheduler.h"

namespace goldthread::bench {

class Scheduling {
 public:
  /// Deals `tiles` of the view, all of them in ascending order or a part, to workers 0 … workers−1.
  Scheduling(const FrameWork& before, std::vector<std::uint32_t> tiles, int workers, int capacity,
             const Strategy& strategy);

  /// Opens the first step, or the next one.
  void open();
  /// The quantum that `worker` is to cast next: tiles to take through the open step, one after the
  /// other. Empty if it has no room or there is none. Valid until the next call.
  std::span<const std::uint32_t> next(int worker);
  /// Calls give(worker), which says whether there was something, as a master does that has opened a
  /// step.
  template <class Give>
  void supply_all(const Give& give) const {
    for (bool any = true; any;) {
      any = false;
      for (int worker = 0; worker < workers_; ++worker) any = give(worker) || any;
    }
  }
  /// `worker` has done so, at this cost.
  void done(int worker, std::uint32_t tile, const StepCost& cost);
  bool finished() const { return scheduler_.finished(); }
  std::size_t tiles() const { return tiles_.size(); }

 private:
  int workers_;
  std::vector<std::uint32_t> quantum_;
  std::vector<std::uint32_t> tiles_;  ///< by the scheduler's number
  TileGrid grid_;
  CostHistory costs_;
  Step last_;  ///< that the frame before took
  Scheduler scheduler_;
};

}  // namespace goldthread::bench
