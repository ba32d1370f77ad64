// SPDX-License-Identifier: Apache-2.0
#include "master/traffic.h"

#include <gtest/gtest.h>

#include "master/cluster.h"

namespace goldthread {
namespace {

using std::chrono::milliseconds;

std::map<std::string, MessageCount> sent(std::uint64_t samples, std::uint64_t done) {
  return {{"Samples", {"Samples", 1, samples}}, {"TilesDone", {"TilesDone", 2, done}}};
}
TrafficMeter::Clock::time_point at(int ms) {
  return TrafficMeter::Clock::time_point(milliseconds(ms));
}

TEST(Traffic, IsTheSumOfAllRanks) {
  std::vector<RankState> ranks(3);
  ranks[0].sent = {{"Present", 1, 10}};
  ranks[1].sent = {{"Samples", 3, 100}, {"TilesDone", 4, 7}};
  ranks[2].sent = {{"Samples", 5, 1000}};
  const auto traffic = traffic_of(ranks);
  ASSERT_EQ(traffic.size(), 3U);
  EXPECT_EQ(traffic.at("Samples").messages, 8U);
  EXPECT_EQ(traffic.at("Samples").bytes, 1100U);
  EXPECT_EQ(traffic.at("Present").bytes, 10U);
}

TEST(TrafficMeter, RatesAreThoseOfTheLastSecondAndTheMostBytesComeFirst) {
  TrafficMeter meter;
  const auto first = meter.sample(at(1000), sent(100, 500));
  EXPECT_EQ(first[0].total.kind, "TilesDone");
  EXPECT_EQ(first[0].bytes_per_s, 0) << "nothing is known yet";
  EXPECT_DOUBLE_EQ(meter.sample(at(1250), sent(200, 500))[1].bytes_per_s, 400);
  for (int ms = 1500; ms < 4000; ms += 250) meter.sample(at(ms), sent(200, 500));
  const auto last = meter.sample(at(4000), sent(5200, 500));
  EXPECT_EQ(last[0].total.kind, "Samples");
  EXPECT_DOUBLE_EQ(last[0].bytes_per_s, 5000) << "of one second, not of three";
  EXPECT_EQ(last[1].bytes_per_s, 0);
}

TEST(TrafficMeter, AKindThatIsNewCountsFromNothing) {
  TrafficMeter meter;
  meter.sample(at(1000), {});
  EXPECT_DOUBLE_EQ(meter.sample(at(1500), sent(100, 0))[0].bytes_per_s, 200);
}

TEST(TrafficMeter, ACountThatFellIsNoRate) {
  TrafficMeter meter;
  meter.sample(at(1000), sent(100, 100));
  for (const TrafficRate& rate : meter.sample(at(2000), sent(50, 0)))
    EXPECT_EQ(rate.bytes_per_s, 0);
}

}  // namespace
}  // namespace goldthread
