// SPDX-License-Identifier: Apache-2.0
#pragma once
// When a rank computed: the time that its threads spent, in bins of 50 ms of its own steady clock,
// for the last few seconds, and the sum since the start. Pure: whoever uses it brings the times,
// and the lock if several threads do.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <vector>

namespace goldthread {

class BusyLog {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kBin{50};
  static constexpr std::int64_t kBins = 128;

  /// A thread computed from `begin` to `end`. Intervals may overlap and come in any order; of what
  /// is older than the bins only the sum is kept.
  void add(Clock::time_point begin, Clock::time_point end) {
    if (end <= begin) return;
    total_ += end - begin;
    const std::int64_t last = number_of(end - Clock::duration(1));
    advance(last);
    for (std::int64_t n = std::max(number_of(begin), newest_ - kBins); n <= last; ++n)
      at(n) += std::min(end, start_of(n + 1)) - std::max(begin, start_of(n));
  }

  /// What other threads of the same rank computed.
  void add(const BusyLog& other) {
    total_ += other.total_;
    advance(other.newest_);
    for (std::int64_t n = std::max(newest_, other.newest_) - kBins; n <= other.newest_; ++n)
      at(n) += other.bins_[slot_of(n)];
  }

  std::chrono::duration<double> total() const { return total_; }

  /// The kBins whole bins before `now`, oldest first: what part of the time of `threads` threads
  /// was computed, 0 … 255.
  std::vector<std::uint8_t> shares(Clock::time_point now, unsigned threads) {
    const std::int64_t end = number_of(now);
    advance(end);
    std::vector<std::uint8_t> shares;
    shares.reserve(kBins);
    const double full = std::chrono::duration<double>(kBin).count() * std::max(1U, threads);
    for (std::int64_t n = end - kBins; n < end; ++n) {
      // Intervals that ended after `now` may have pushed the oldest bins out.
      const Clock::duration busy = n < newest_ - kBins ? Clock::duration(0) : at(n);
      const double share = std::chrono::duration<double>(busy).count() / full;
      shares.push_back(static_cast<std::uint8_t>(std::lround(255 * std::min(share, 1.0))));
    }
    return shares;
  }
  /// How long ago the newest of those bins ended.
  static std::chrono::microseconds age(Clock::time_point now) {
    return std::chrono::duration_cast<std::chrono::microseconds>(now - start_of(number_of(now)));
  }

 private:
  static std::int64_t number_of(Clock::time_point time) { return time.time_since_epoch() / kBin; }
  static Clock::time_point start_of(std::int64_t number) {
    return Clock::time_point(number * std::chrono::duration_cast<Clock::duration>(kBin));
  }
  /// The bin of a number from newest_ − kBins to newest_.
  Clock::duration& at(std::int64_t number) { return bins_[slot_of(number)]; }
  static std::size_t slot_of(std::int64_t number) {
    constexpr std::int64_t kSize = kBins + 1;
    return static_cast<std::size_t>((number % kSize + kSize) % kSize);
  }
  void advance(std::int64_t newest) {
    if (newest <= newest_) return;
    for (std::int64_t n = std::max(newest_, newest - kBins - 1) + 1; n <= newest; ++n) at(n) = {};
    newest_ = newest;
  }

  std::array<Clock::duration, kBins + 1> bins_{};  // and the one that is not over yet
  std::int64_t newest_ = 0;
  Clock::duration total_{0};
};

}  // namespace goldthread
