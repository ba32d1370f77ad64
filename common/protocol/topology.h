// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which rank plays which role: 0 the master, then the compositors, then the workers.

#include <string>

#include "common/base/result.h"
#include "common/protocol/messages.h"

namespace goldthread {

struct Topology {
  int compositors = 1;
  int workers = 1;

  int size() const { return 1 + compositors + workers; }
  Rank compositor(int index) const { return {1 + index}; }
  Rank worker(int index) const { return {1 + compositors + index}; }
  /// The gateway is served by the first compositor.
  Rank gateway() const { return compositor(0); }
  int worker_index(Rank rank) const { return rank.value - 1 - compositors; }
  int compositor_index(Rank rank) const { return rank.value - 1; }
  Role role_of(Rank rank) const {
    if (rank.value == 0) return Role::kMaster;
    return rank.value <= compositors ? Role::kCompositor : Role::kWorker;
  }

  /// The roles of `ranks` processes with `compositors` compositors; the rest are workers.
  static Result<Topology> for_ranks(int ranks, int compositors) {
    const int workers = ranks - 1 - compositors;
    if (workers < 1) {
      return Failure{.where = "mpirun -n " + std::to_string(ranks),
                     .what = "too few ranks for a master, " + std::to_string(compositors) +
                             (compositors == 1 ? " compositor" : " compositors") + " and a worker",
                     .mend = "start at least " + std::to_string(compositors + 2) +
                             " ranks, or run without mpirun",
                     .status = ExitStatus::kUsage};
    }
    return Topology{compositors, workers};
  }
};

}  // namespace goldthread
