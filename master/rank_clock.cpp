// SPDX-License-Identifier: Apache-2.0
#include "master/rank_clock.h"

#include "common/base/busy_log.h"

namespace goldthread {
namespace {

using std::chrono::microseconds;

constexpr std::uint64_t kLatest_us = std::uint64_t{1} << 60;

}  // namespace

std::optional<RankActivity> RankClock::place(const Activity& answer, Clock::time_point now) {
  const auto heard = std::chrono::duration_cast<microseconds>(now.time_since_epoch());
  const bool sane = answer.share.size() == BusyLog::kBins && answer.now_us < kLatest_us &&
                    answer.age_us <= answer.now_us && answer.asked_us < kLatest_us &&
                    microseconds(answer.asked_us) <= heard;
  if (!sane) return {};
  const microseconds asked(answer.asked_us), remote(answer.now_us);
  const microseconds half = (heard - asked + microseconds(1)) / 2;
  if (!known_ || half <= error(now)) {
    known_ = true;
    offset_ = asked + (heard - asked) / 2 - remote;
    bound_ = half;
    found_ = now;
  }
  const microseconds end = remote + offset_ - microseconds(answer.age_us);
  return RankActivity{answer.asked_us, answer.share, Clock::time_point(end), error(now)};
}

microseconds RankClock::error(Clock::time_point now) const {
  const auto drifted = std::chrono::duration<double, std::micro>(now - found_) * kDrift;
  return bound_ + std::chrono::ceil<microseconds>(drifted);
}

}  // namespace goldthread
