// SPDX-License-Identifier: Apache-2.0
#pragma once
// Processor time of the calling thread: what else the machine does is not in it.

#include <ctime>

namespace goldthread::bench {

inline double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

/// What `work` takes of it.
template <class Work>
double thread_seconds_of(const Work& work) {
  const double start = thread_seconds();
  work();
  return thread_seconds() - start;
}

}  // namespace goldthread::bench
