// SPDX-License-Identifier: Apache-2.0
#pragma once
// One frame on a cluster that does not exist: the project's own scheduler, fed by events whose
// times come from a cost image and a cluster model. Deterministic and pure.
//
// A master is a server: it takes one message at a time, in the order in which they come, and what
// it sends leaves while it works. So is a compositor. A worker's thread computes, then sends: its
// core is busy with both. Messages between two ranks take as long whatever else is on the way.

#include <cstdint>

#include "bench/scale/cluster_model.h"
#include "bench/scale/cost_record.h"

namespace goldthread::bench {

struct SimulatedFrame {
  double us = 0;          ///< from the view's begin until the master knows that it is held
  double efficiency = 0;  ///< what the tiles cost / (threads of all workers × time)
  /// Shares of the time in which the busiest of a kind works.
  double master_busy = 0;
  double top_busy = 0;  ///< the master above, if there is one
  double compositor_busy = 0;
  double master_wait_us = 0;       ///< mean of a report, until its master takes it
  double compositors_late_us = 0;  ///< from the last tile's report until all bands were held
  double imbalance = 1;            ///< what the busiest thread computed / the mean of all
  std::uint64_t quanta = 0;
  std::uint64_t taken_over = 0;  ///< tiles whose earlier steps were cast again
  std::uint64_t top_messages = 0;
  double most_messages = 0;  ///< that a master took or sent, a second
};

/// Tiles cost what `now` says; the master predicts what `before` says. Both of the same grid and as
/// many steps.
SimulatedFrame simulate(const FrameWork& now, const FrameWork& before, const ClusterModel& model,
                        const ClusterShape& shape);

}  // namespace goldthread::bench
