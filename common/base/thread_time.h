// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a thread has computed: time that it waited, or that others had its core, does not count.

#include <chrono>
#include <ctime>

namespace goldthread {

/// Time on a core of the calling thread since it began.
inline std::chrono::nanoseconds thread_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

}  // namespace goldthread
