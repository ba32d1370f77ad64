// SPDX-License-Identifier: Apache-2.0
#pragma once
// How much memory this process has needed.

#include <cstdint>
#include <fstream>
#include <string>

namespace goldthread {

/// The most that was resident at a time, shared memory included; 0 where the system does not tell.
inline std::uint64_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string key; status >> key;) {
    if (key != "VmHWM:") continue;
    std::uint64_t kibibytes = 0;
    status >> kibibytes;
    return kibibytes * 1024;
  }
  return 0;
}

}  // namespace goldthread
