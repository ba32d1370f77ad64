// SPDX-License-Identifier: Apache-2.0
#include "bench/error/rounds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/error/process.h"

namespace goldthread::bench {
namespace {

const auto kSilent = [](double) {};

TEST(BenchRounds, MethodsTakeTurnsBackAndForthAndTheFirstFrameDoesNotCount) {
  std::string order;
  std::vector<Contestant> contestants{{"a", [&] { return order += 'a', double(order.size()); }},
                                      {"b", [&] { return order += 'b', double(order.size()); }}};
  run_rounds(contestants, 3, kSilent);
  EXPECT_EQ(order, "abbaabba");
  EXPECT_THAT(contestants[0].seconds, testing::ElementsAre(4, 5, 8));
  EXPECT_THAT(contestants[1].seconds, testing::ElementsAre(3, 6, 7));
}

TEST(BenchRounds, AMethodThatFailsIsLeftOutAndTheOthersGoOn) {
  int calls = 0;
  std::vector<Contestant> contestants{{"bad",
                                       [&]() -> double {
                                         ++calls;
                                         throw PeerFailure("is not there");
                                       }},
                                      {"good", [] { return 1.0; }}};
  run_rounds(contestants, 4, kSilent);
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(contestants[0].failure, "is not there");
  EXPECT_EQ(contestants[1].seconds.size(), 4u);
}

TEST(BenchRounds, ProgressAscendsWithinItsRange) {
  std::vector<double> told;
  std::vector<Contestant> contestants{{"a", [] { return 1.0; }}, {"b", [] { return 1.0; }}};
  run_rounds(contestants, 2, [&](double fraction) { told.push_back(fraction); });
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_GE(told.front(), 0);
  EXPECT_LT(told.back(), 1);
}

TEST(BenchRounds, ARatioIsTheMedianOfTheRoundsOrThatOfTheMinima) {
  const Contestant base{"base", {}, {1, 2, 30}}, one{"one", {}, {2, 6, 120}};
  EXPECT_EQ(median_ratio(one, base), 3);
  EXPECT_EQ(ratio_of_minima(one, base), 2);
}

}  // namespace
}  // namespace goldthread::bench
