// SPDX-License-Identifier: Apache-2.0
#pragma once
// What another rank's clock says in the master's time. Each question and its answer bound the
// offset by half their round trip (Cristian, Probabilistic clock synchronization, 1989); the best
// bound of all is kept and widened with its age by what clocks drift. Pure.

#include <chrono>
#include <optional>
#include <vector>

#include "common/protocol/messages.h"

namespace goldthread {

/// When a rank computed lately, by the master's clock.
struct RankActivity {
  std::uint64_t asked_us = 0;                 ///< of the request that this answers; 0: none yet
  std::vector<std::uint8_t> share;            ///< as Activity::share
  std::chrono::steady_clock::time_point end;  ///< of the newest bin
  std::chrono::microseconds error{0};         ///< the most that `end` may be off
};

class RankClock {
 public:
  using Clock = std::chrono::steady_clock;
  /// More than what the oscillator of a computer is off, relative.
  static constexpr double kDrift = 1e-4;

  /// An answer that was heard at `now`, in the master's time; nothing if no honest rank says so.
  std::optional<RankActivity> place(const Activity& answer, Clock::time_point now);

 private:
  std::chrono::microseconds error(Clock::time_point now) const;

  bool known_ = false;
  std::chrono::microseconds offset_{0};  ///< the master's time less the rank's
  std::chrono::microseconds bound_{0};   ///< of its error, when it was found
  Clock::time_point found_;
};

}  // namespace goldthread
