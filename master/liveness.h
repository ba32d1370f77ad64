// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which ranks have gone silent. Pure: the clock is an argument. A rank that was lost stays lost,
// even if it speaks again: its work has been given to others.

#include <chrono>
#include <vector>

#include "common/base/types.h"

namespace goldthread {

class Liveness {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Ranks 1 … count−1 are watched from `now` on; the master need not watch itself.
  void watch(int count, Time now);
  /// `rank` has said something.
  void heard(Rank rank, Time now);
  /// The ranks that became lost since the last call: silent for longer than `silence`.
  std::vector<Rank> newly_lost(Time now, std::chrono::milliseconds silence);

 private:
  struct Watched {
    Time heard;
    bool lost = false;
  };
  std::vector<Watched> ranks_;  // by rank; the master's entry is unused
};

}  // namespace goldthread
