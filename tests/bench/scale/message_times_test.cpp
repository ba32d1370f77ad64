// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/message_times.h"

#include <gtest/gtest.h>

namespace goldthread::bench {
namespace {

TEST(MessageTimes, BetweenThreadsCoverAllSizes) {
  const MeasuredLink link = time_loopback(true);
  ASSERT_EQ(link.times.size(), 8U);
  EXPECT_EQ(link.times.front().bytes, 64);
  EXPECT_EQ(link.times.back().bytes, 1 << 20);
  for (const MessageTime& time : link.times) {
    EXPECT_GT(time.send_us, 0);
    EXPECT_GT(time.receive_us, 0);
    EXPECT_GE(time.transit_us, 0);
  }
}

TEST(MessageTimes, AreFittedSideBySide) {
  MeasuredLink link{"made up", {}};
  for (const double bytes : {64.0, 4096.0, 262144.0})
    link.times.push_back({bytes, 1 + 1e-3 * bytes, 2 + 2e-3 * bytes, 40 + 3e-3 * bytes});
  const FittedLink fit = fit_link(link);
  EXPECT_NEAR(fit.costs.send.us, 1, 1e-6);
  EXPECT_NEAR(fit.costs.receive.us_per_byte, 2e-3, 1e-9);
  EXPECT_NEAR(fit.costs.transit.at(1000), 43, 1e-6);
  EXPECT_NEAR(fit.send_residual, 0, 1e-6);
}

}  // namespace
}  // namespace goldthread::bench
