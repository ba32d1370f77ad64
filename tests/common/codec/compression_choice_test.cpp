// SPDX-License-Identifier: Apache-2.0
#include "common/codec/compression_choice.h"

#include <gtest/gtest.h>

namespace goldthread {
namespace {

// What tiles of the head gave on one core.
constexpr CodecEstimate kHead{0.51, 650e6, 1700e6};
constexpr CoreNeed kWorker{1, 0.5};

TEST(CompressionChoice, CompressesWhereTheLinkIsSlowerThanTheCores) {
  struct Row {
    const char* link;
    double bytes_per_s;
    CodecEstimate codec;
    bool on;
  };
  const Row table[] = {
      {"100 Mbit/s", 12.0e6, kHead, true},
      {"1 Gbit/s", 119.6e6, kHead, true},
      {"1 Gbit/s, slow core", 119.6e6, {0.51, 150e6, 600e6}, false},
      {"1 Gbit/s, noise", 119.6e6, {0.99, 400e6, 1700e6}, false},
      {"1 Gbit/s, constant", 119.6e6, {0.01, 1000e6, 3000e6}, true},
      {"10 Gbit/s", 1190e6, kHead, false},
      {"TCP between hosts of one machine", 4.3e9, kHead, false},
      {"TCP on loopback", 7e9, kHead, false},
      {"shared memory", 10e9, kHead, false},
      {"10 Gbit/s, constant, fast core", 1190e6, {0.01, 4000e6, 8000e6}, true},
  };
  for (const Row& row : table) {
    CompressionChoice choice(kWorker);
    EXPECT_EQ(choice.decide(row.bytes_per_s, row.codec), row.on) << row.link;
    EXPECT_EQ(choice.on(), row.on) << row.link;
  }
}

TEST(CompressionChoice, PaysExactlyWhereTimeSavedIsTimeSpent) {
  // 1/link · (1 − 0.5) = 1/400e6 + 0.5/1000e6 at a link of 166.7e6: far enough on either side it is
  // clear.
  const CodecEstimate codec{0.5, 400e6, 1000e6};
  CompressionChoice choice(kWorker);
  EXPECT_TRUE(choice.decide(166.7e6 / 1.25, codec));
  EXPECT_TRUE(choice.decide(166.7e6 * 1.15, codec)) << "hysteresis";
  EXPECT_FALSE(choice.decide(166.7e6 * 1.25, codec));
  EXPECT_FALSE(choice.decide(166.7e6 / 1.15, codec)) << "hysteresis";
  EXPECT_TRUE(choice.decide(166.7e6 / 1.25, codec));
}

TEST(CompressionChoice, AnIdleCoreMakesItPayOnAFasterLink) {
  CompressionChoice needed({1, 1}), idle({0.25, 0.25});
  EXPECT_FALSE(needed.decide(400e6, kHead));
  EXPECT_TRUE(idle.decide(400e6, kHead));
}

TEST(CompressionChoice, WithoutAMeasurementEverythingStaysAsItIs) {
  CompressionChoice choice(kWorker);
  EXPECT_FALSE(choice.decide(0, kHead));
  EXPECT_FALSE(choice.decide(119.6e6, {}));
  EXPECT_TRUE(choice.decide(119.6e6, kHead));
  EXPECT_TRUE(choice.decide(0, kHead));
}

}  // namespace
}  // namespace goldthread
