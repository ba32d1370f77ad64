// SPDX-License-Identifier: Apache-2.0
#include "common/base/busy_log.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace goldthread {
namespace {

using std::chrono::milliseconds;
using Time = BusyLog::Clock::time_point;

Time at(int ms) { return Time(milliseconds(ms)); }

std::vector<std::uint8_t> nothing_but(std::map<int, int> shares) {
  std::vector<std::uint8_t> all(BusyLog::kBins);
  for (const auto& [from_newest, share] : shares)
    all[all.size() - 1 - static_cast<std::size_t>(from_newest)] = static_cast<std::uint8_t>(share);
  return all;
}

TEST(BusyLog, AnIntervalIsSpreadOverItsBins) {
  BusyLog log;
  log.add(at(10'025), at(10'110));  // half a bin, a whole one, a fifth
  EXPECT_EQ(log.shares(at(10'150), 1), nothing_but({{2, 128}, {1, 255}, {0, 51}}));
  EXPECT_DOUBLE_EQ(log.total().count(), 0.085);
}

TEST(BusyLog, TheBinThatIsNotOverIsNotTold) {
  BusyLog log;
  log.add(at(10'050), at(10'120));
  EXPECT_EQ(log.shares(at(10'120), 1), nothing_but({{0, 255}}));
  EXPECT_EQ(BusyLog::age(at(10'120)), milliseconds(20));
  EXPECT_EQ(log.shares(at(10'150), 1), nothing_but({{1, 255}, {0, 102}}));
  EXPECT_EQ(BusyLog::age(at(10'150)), milliseconds(0));
}

TEST(BusyLog, SharesAreOfWhatAllThreadsCould) {
  BusyLog log;
  for (int thread = 0; thread < 3; ++thread) log.add(at(10'000), at(10'050));
  EXPECT_EQ(log.shares(at(10'050), 4), nothing_but({{0, 191}}));
}

TEST(BusyLog, WhatIsOlderThanTheBinsCountsInTheSumAlone) {
  BusyLog log;
  log.add(at(10'000), at(10'050));
  EXPECT_EQ(log.shares(at(10'000 + 50 * 128), 1), nothing_but({{127, 255}}));
  EXPECT_EQ(log.shares(at(10'000 + 50 * 129), 1), nothing_but({}));
  log.add(at(10'000), at(10'050));  // told of late
  EXPECT_EQ(log.shares(at(10'000 + 50 * 129), 1), nothing_but({}));
  EXPECT_DOUBLE_EQ(log.total().count(), 0.1);
}

TEST(BusyLog, ALongIntervalFillsEveryBin) {
  BusyLog log;
  log.add(at(1'000), at(100'000));
  EXPECT_EQ(log.shares(at(100'000), 1), std::vector<std::uint8_t>(BusyLog::kBins, 255));
  EXPECT_DOUBLE_EQ(log.total().count(), 99);
}

TEST(BusyLog, WhatCameAfterTheTimeThatIsAskedForShowsNowhere) {
  BusyLog log;
  log.add(at(10'000), at(10'050));
  log.add(at(10'100), at(10'250));
  EXPECT_EQ(log.shares(at(10'100), 1), nothing_but({{1, 255}}));
}

TEST(BusyLog, EmptyAndBackwardIntervalsAreNothing) {
  BusyLog log;
  log.add(at(10'000), at(10'000));
  log.add(at(10'010), at(10'000));
  EXPECT_EQ(log.total().count(), 0);
  EXPECT_EQ(log.shares(at(10'050), 1), nothing_but({}));
}

TEST(BusyLog, AgreesWithCountingMillisecondsWhateverTheOrder) {
  std::mt19937 random(7);
  const int kThreads = 5, kEnd = 20'000;
  for (int round = 0; round < 20; ++round) {
    BusyLog log;
    std::vector<int> busy(kEnd);  // threads in each millisecond
    std::vector<std::pair<int, int>> intervals;
    for (int thread = 0; thread < kThreads; ++thread)
      for (int time = int(random() % 900); time < kEnd;) {
        const int end = std::min(kEnd, time + 1 + int(random() % 300));
        intervals.emplace_back(time, end);
        for (int ms = time; ms < end; ++ms) ++busy[std::size_t(ms)];
        time = end + int(random() % 200);
      }
    std::shuffle(intervals.begin(), intervals.end(), random);
    for (const auto& [begin, end] : intervals) log.add(at(begin), at(end));
    const auto shares = log.shares(at(kEnd), kThreads);
    for (int bin = 0; bin < BusyLog::kBins; ++bin) {
      const int first = kEnd - 50 * int(BusyLog::kBins - bin);
      int sum = 0;
      for (int ms = first; ms < first + 50; ++ms) sum += busy[std::size_t(ms)];
      EXPECT_NEAR(shares[std::size_t(bin)], 255.0 * sum / (50 * kThreads), 0.5 + 1e-9) << bin;
    }
  }
}

}  // namespace
}  // namespace goldthread
