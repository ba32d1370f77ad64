// SPDX-License-Identifier: Apache-2.0
#pragma once
// The master's own scheduler, driven by what the tiles of a real frame cost: the balance that as
// many workers would have, each of one thread with a core for itself, where messages take no time.
// On a machine with fewer cores than workers these share cores, and who gets less of them gets
// fewer tiles, which says nothing about the schedule. Pure.

#include "bench/balance/cast_frame.h"
#include "master/scheduler.h"

namespace goldthread::bench {

struct Replayed {
  double seconds = 0;  ///< until the last tile of the last step
  double imbalance = 0;
};

/// `predicted`: what the scheduler is told when the frame begins (history_of). A worker that takes
/// a tile over casts its earlier steps again.
Replayed replay(const CastFrame& frame, CostHistory predicted, int workers, Strategy strategy);

}  // namespace goldthread::bench
