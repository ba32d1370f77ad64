// SPDX-License-Identifier: Apache-2.0
#include "master/traffic.h"

#include <algorithm>

#include "master/cluster.h"

namespace goldthread {

std::map<std::string, MessageCount> traffic_of(const std::vector<RankState>& ranks) {
  std::map<std::string, MessageCount> sums;
  for (const RankState& rank : ranks) {
    for (const MessageCount& count : rank.sent) {
      MessageCount& sum = sums[count.kind];
      sum.kind = count.kind;
      sum.messages += count.messages;
      sum.bytes += count.bytes;
    }
  }
  return sums;
}

std::vector<TrafficRate> TrafficMeter::sample(Clock::time_point now,
                                              std::map<std::string, MessageCount> traffic) {
  while (samples_.size() > 1 && now - samples_[1].first >= kWindow) samples_.pop_front();
  std::vector<TrafficRate> rates;
  for (const auto& [kind, count] : traffic) {
    TrafficRate rate{count, 0};
    if (!samples_.empty()) {
      const auto& [then, before] = samples_.front();
      const auto known = before.find(kind);
      const std::uint64_t old = known == before.end() ? 0 : known->second.bytes;
      const double seconds = std::chrono::duration<double>(now - then).count();
      if (count.bytes > old && seconds > 0)
        rate.bytes_per_s = static_cast<double>(count.bytes - old) / seconds;
    }
    rates.push_back(std::move(rate));
  }
  std::stable_sort(rates.begin(), rates.end(), [](const TrafficRate& a, const TrafficRate& b) {
    return a.total.bytes > b.total.bytes;
  });
  samples_.emplace_back(now, std::move(traffic));
  return rates;
}

}  // namespace goldthread
