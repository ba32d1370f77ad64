// SPDX-License-Identifier: Apache-2.0
#pragma once
// Processor time of the calling thread: what else the machine does is not in it.

#include <chrono>
#include <ctime>

namespace goldthread {

/// A clock in the standard's sense; only times of one thread can be compared.
struct ThreadClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<ThreadClock>;
  static constexpr bool is_steady = true;

  static time_point now() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return time_point(std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec));
  }
};

/// What the calling thread has computed since it began, s.
inline double thread_seconds() {
  return std::chrono::duration<double>(ThreadClock::now().time_since_epoch()).count();
}

}  // namespace goldthread
