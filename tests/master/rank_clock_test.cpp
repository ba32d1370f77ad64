// SPDX-License-Identifier: Apache-2.0
#include "master/rank_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "common/base/busy_log.h"

namespace goldthread {
namespace {

using std::chrono::microseconds;
using Time = RankClock::Clock::time_point;

Activity answer(std::uint64_t asked_us, std::uint64_t now_us, std::uint32_t age_us = 0) {
  return {asked_us, now_us, age_us, std::vector<std::uint8_t>(BusyLog::kBins, 1)};
}
Time at(std::int64_t us) { return Time(microseconds(us)); }

TEST(RankClock, AnAnswerLiesInTheMiddleOfItsRoundTripGiveOrTakeHalfOfIt) {
  RankClock clock;
  const auto placed = clock.place(answer(1'000'000, 5'000'300, 20'000), at(1'000'800));
  ASSERT_TRUE(placed);
  EXPECT_EQ(placed->end, at(1'000'400 - 20'000));
  EXPECT_EQ(placed->error, microseconds(400));
  EXPECT_EQ(placed->asked_us, 1'000'000U);
  EXPECT_EQ(placed->share.size(), std::size_t(BusyLog::kBins));
}

TEST(RankClock, ABetterAnswerReplacesAWorseOneAndAWorseOneDoesNot) {
  RankClock clock;
  EXPECT_EQ(clock.place(answer(1'000'000, 0), at(1'010'000))->error, microseconds(5'000));
  EXPECT_EQ(clock.place(answer(2'000'000, 1'000'000), at(2'000'200))->error, microseconds(100));
  const auto late = clock.place(answer(3'000'000, 2'000'000), at(3'040'000));
  EXPECT_EQ(late->end, at(3'000'100)) << "by the best answer, not the middle of this one";
  EXPECT_EQ(late->error, microseconds(100 + 104)) << "and what clocks drift in 1.0398 s";
}

/// The oracle: clocks that are simulated, with offsets, drifts and delays that nobody tells.
TEST(RankClock, TheTrueTimeIsAlwaysWithinTheErrorThatIsTold) {
  std::mt19937 random(3);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int round = 0; round < 200; ++round) {
    RankClock clock;
    const double drift = uniform(-0.99, 0.99) * RankClock::kDrift;
    const double start = uniform(1e6, 1e12);
    double time = 5e6;
    for (int i = 0; i < 100; ++i) {
      time += uniform(1e5, 1e6);
      const double there = time + std::exp(uniform(3, 11)), back = there + std::exp(uniform(3, 11));
      const auto remote = static_cast<std::uint64_t>(start + (1 + drift) * there);
      const auto placed = clock.place(answer(static_cast<std::uint64_t>(time), remote),
                                      at(static_cast<std::int64_t>(back)));
      ASSERT_TRUE(placed);
      const auto told = std::chrono::duration<double, std::micro>(placed->end.time_since_epoch());
      const auto error = static_cast<double>(placed->error.count());
      EXPECT_LE(std::abs(told.count() - there), error + 2) << "whole microseconds";
      EXPECT_LE(error, 0.5 * (back - time) + 2) << "never worse than this answer alone";
      time = back;
    }
  }
}

TEST(RankClock, WhatNoHonestRankSaysIsNotUsed) {
  constexpr auto kMost = std::numeric_limits<std::uint64_t>::max();
  RankClock clock;
  EXPECT_FALSE(clock.place(answer(2'000'001, 5), at(2'000'000))) << "asked in the future";
  EXPECT_FALSE(clock.place(answer(kMost, 5), at(2'000'000)));
  EXPECT_FALSE(clock.place(answer(1, kMost), at(2'000'000)));
  EXPECT_FALSE(clock.place(answer(1, 5, 6), at(2'000'000))) << "before its clock began";
  for (const std::size_t bins : {0, 1, 127, 129, 100'000}) {
    Activity other = answer(1, 5);
    other.share.resize(bins);
    EXPECT_FALSE(clock.place(other, at(2'000'000))) << bins;
  }
  EXPECT_TRUE(clock.place(answer(1, 5), at(2'000'000)));
}

}  // namespace
}  // namespace goldthread
