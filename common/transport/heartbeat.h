// SPDX-License-Identifier: Apache-2.0
#pragma once
// A rank's sign of life to the master. MPI reports no death of a peer: only silence tells.

#include <chrono>

#include "common/transport/post.h"

namespace goldthread {

/// How often a rank says that it lives, and after what silence it counts as lost. A rank of a
/// machine that is overloaded must not be taken for dead.
constexpr std::chrono::milliseconds kHeartbeat{1000};
constexpr std::chrono::milliseconds kSilence{10000};

class HeartbeatSender {
 public:
  /// Sends a heartbeat if the last one is old enough. To be called in a rank's loop.
  void beat(Post& post) {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < kHeartbeat) return;
    last_ = now;
    post.to_master(Heartbeat{});
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace goldthread
