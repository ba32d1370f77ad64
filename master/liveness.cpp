// SPDX-License-Identifier: Apache-2.0
#include "master/liveness.h"

namespace goldthread {

void Liveness::watch(int count, Time now) {
  ranks_.assign(static_cast<std::size_t>(count), {now, false});
}

void Liveness::heard(Rank rank, Time now) {
  if (static_cast<std::size_t>(rank.value) < ranks_.size()) {
    ranks_[static_cast<std::size_t>(rank.value)].heard = now;
  }
}

std::vector<Rank> Liveness::newly_lost(Time now, std::chrono::milliseconds silence) {
  std::vector<Rank> lost;
  for (std::size_t i = 1; i < ranks_.size(); ++i) {
    if (ranks_[i].lost || now - ranks_[i].heard <= silence) continue;
    ranks_[i].lost = true;
    lost.push_back({static_cast<std::int32_t>(i)});
  }
  return lost;
}

}  // namespace goldthread
