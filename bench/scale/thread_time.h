// SPDX-License-Identifier: Apache-2.0
#pragma once
// What something takes of the calling thread's processor.

#include <chrono>

#include "common/base/thread_clock.h"

namespace goldthread::bench {

template <class Work>
double thread_us_of(const Work& work) {
  const auto begin = ThreadClock::now();
  work();
  return std::chrono::duration<double, std::micro>(ThreadClock::now() - begin).count();
}

}  // namespace goldthread::bench
