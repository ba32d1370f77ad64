// SPDX-License-Identifier: Apache-2.0
#pragma once
// A cluster in numbers: what its roles and its links spend on messages. All times in µs.

#include <algorithm>
#include <vector>

#include "master/scheduler.h"

namespace goldthread::bench {

/// What something costs by its bytes.
struct Affine {
  double us = 0;
  double us_per_byte = 0;
  double at(double bytes) const { return us + us_per_byte * bytes; }
};

/// A message between two ranks: the sender's processor time, the receiver's, and what passes in
/// between.
struct LinkCosts {
  Affine send;
  Affine receive;
  Affine transit;
};

/// What a master computes, without sending and receiving.
struct MasterCosts {
  int workers = 1;       ///< measured with so many
  double done_us = 0;    ///< for each TileDone: decode, Scheduler::done, cost history
  double supply_us = 0;  ///< for each quantum: Scheduler::next, encode
  double queue_us = 0;   ///< for each tile when a step is opened, before its first quantum goes out
  double begin_us = 0;   ///< for each worker when a view begins
};

struct ClusterModel {
  LinkCosts link;
  std::vector<MasterCosts> master;  ///< ascending by workers; at least one
  Affine place;                     ///< a compositor's, for a tile's samples

  /// As measured with that many workers, or the next more.
  const MasterCosts& master_of(int workers) const {
    const auto found = std::find_if(master.begin(), master.end(),
                                    [&](const MasterCosts& m) { return m.workers >= workers; });
    return found == master.end() ? master.back() : *found;
  }
};

struct ClusterShape {
  int workers = 1;
  int threads = 1;  ///< of each worker, each on a core of its own
  int compositors = 1;
  /// 1: one master deals all tiles. More: that many sub-masters deal them, each to its share of the
  /// workers, and a master above deals the picture to them.
  int masters = 1;
  int tiles_per_chunk = 1;  ///< what the master above deals at a time
  int spare = 1;            ///< quanta that a worker holds beyond those it computes
  Strategy strategy = {.spare_us = kSpareUs};  ///< of each master that deals tiles
};

}  // namespace goldthread::bench
