// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the ranks have sent each other, by kind of message. Pure.

#include <chrono>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/protocol/messages.h"

namespace goldthread {

struct RankState;

/// The counts of all ranks by kind, as they answered last.
std::map<std::string, MessageCount> traffic_of(const std::vector<RankState>& ranks);

struct TrafficRate {
  MessageCount total;  ///< since the start
  double bytes_per_s = 0;
};

/// The rates of the last second.
class TrafficMeter {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kWindow{1};

  /// Notes what had been sent by `now`, later than at the call before. The most bytes first.
  std::vector<TrafficRate> sample(Clock::time_point now,
                                  std::map<std::string, MessageCount> traffic);

 private:
  /// The first is the newest that is at least kWindow old, if there is one.
  std::deque<std::pair<Clock::time_point, std::map<std::string, MessageCount>>> samples_;
};

}  // namespace goldthread
