// SPDX-License-Identifier: Apache-2.0
#include "master/balance.h"

#include <gtest/gtest.h>

#include <vector>

namespace goldthread {
namespace {

TEST(Imbalance, IsTheBusiestOverTheMeanLessOne) {
  EXPECT_DOUBLE_EQ(imbalance(std::vector{1.0, 1.0, 1.0, 5.0}), 1.5);
  EXPECT_DOUBLE_EQ(imbalance(std::vector{0.0, 2.0}), 1);
  EXPECT_DOUBLE_EQ(imbalance(std::vector{3.0, 3.0, 3.0}), 0);
  EXPECT_EQ(imbalance(std::vector{0.0, 0.0}), 0);
  EXPECT_EQ(imbalance({}), 0);
}

TEST(PredictionError, IsWhatWasOffOverWhatWas) {
  EXPECT_DOUBLE_EQ(prediction_error(std::vector{1.0, 2.0, 6.0}, std::vector{2.0, 2.0, 4.0}), 0.375);
  EXPECT_EQ(prediction_error(std::vector{4.0}, std::vector{4.0}), 0);
  EXPECT_EQ(prediction_error(std::vector{4.0}, std::vector{0.0}), 0);
}

}  // namespace
}  // namespace goldthread
