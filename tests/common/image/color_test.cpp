// SPDX-License-Identifier: Apache-2.0
#include "common/image/color.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace goldthread {
namespace {

TEST(Srgb, EndsStayEnds) {
  EXPECT_EQ(srgb_from_linear(0), 0);
  EXPECT_NEAR(srgb_from_linear(1), 1, 1e-15);
  EXPECT_EQ(linear_from_srgb(0), 0);
  EXPECT_EQ(linear_from_srgb(1), 1);
}

TEST(Srgb, KnownValuesOfTheStandard) {
  EXPECT_NEAR(linear_from_srgb(0.5), 0.214041140482232, 1e-14);
  EXPECT_NEAR(srgb_from_linear(0.18), 0.461356129500442, 1e-14);
  EXPECT_DOUBLE_EQ(linear_from_srgb(0.04), 0.04 / 12.92);
  EXPECT_DOUBLE_EQ(srgb_from_linear(0.003), 0.003 * 12.92);
}

TEST(Srgb, EncodingUndoesDecodingForEach8BitLevel) {
  for (int level = 0; level < 256; ++level) {
    EXPECT_EQ(to_8_bits(srgb_from_linear(linear_from_srgb(level / 255.0))), level);
  }
}

TEST(Srgb, RisesEverywhere) {
  double before = -1;
  for (int i = 0; i <= 100000; ++i) {
    const double encoded = srgb_from_linear(i / 100000.0);
    EXPECT_GT(encoded, before);
    before = encoded;
  }
}

TEST(To8Bits, RoundsToTheNearestLevelAndClamps) {
  EXPECT_EQ(to_8_bits(0.49 / 255), 0);
  EXPECT_EQ(to_8_bits(0.51 / 255), 1);
  EXPECT_EQ(to_8_bits(2), 255);
  EXPECT_EQ(to_8_bits(-1), 0);
  EXPECT_EQ(to_8_bits(std::numeric_limits<double>::infinity()), 255);
  EXPECT_EQ(to_8_bits(std::numeric_limits<double>::quiet_NaN()), 0);
}

}  // namespace
}  // namespace goldthread
