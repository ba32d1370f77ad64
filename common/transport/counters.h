// SPDX-License-Identifier: Apache-2.0
#pragma once
// A rank's answer to ReportCounters.

#include "common/base/busy_log.h"
#include "common/base/memory.h"
#include "common/transport/post.h"

namespace goldthread {

inline std::uint64_t microseconds_of(BusyLog::Clock::time_point time) {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count());
}

/// What the rank of `post` has sent, and what `log` says of its `threads` threads up to `now`.
inline Counters counters_of(const Post& post, const ReportCounters& request, BusyLog log,
                            unsigned threads, BusyLog::Clock::time_point now) {
  Counters counters{post.sent(), {}, log.total().count(), peak_memory_bytes(), {}};
  if (request.activity) {
    counters.activity =
        Activity{request.asked_us, microseconds_of(now),
                 static_cast<std::uint32_t>(BusyLog::age(now).count()), log.shares(now, threads)};
  }
  return counters;
}

}  // namespace goldthread
