// SPDX-License-Identifier: Apache-2.0
#pragma once
// How many cores this process may use.

#include <sched.h>

#include <algorithm>

namespace goldthread {

/// The cores of the process's affinity mask, at least 1.
inline unsigned usable_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) != 0) return 1;
  return static_cast<unsigned>(std::max(1, CPU_COUNT(&set)));
}

}  // namespace goldthread
