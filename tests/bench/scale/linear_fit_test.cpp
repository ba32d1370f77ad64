// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/linear_fit.h"

#include <gtest/gtest.h>

#include <vector>

namespace goldthread::bench {
namespace {

TEST(LinearFit, FindsWhatTimesWereMadeOf) {
  std::vector<TimedTerms> measured;
  for (const double bytes : {64.0, 4096.0, 65536.0, 1048576.0})
    measured.push_back({{1, bytes}, 3 + 0.002 * bytes});
  const LinearFit fit = fit_linear(measured);
  EXPECT_NEAR(fit.first, 3, 1e-6);
  EXPECT_NEAR(fit.second, 0.002, 1e-9);
  EXPECT_NEAR(fit.worst, 0, 1e-6);
}

TEST(LinearFit, SmallTimesCountAsMuchAsLargeOnes) {
  // The largest is off by a tenth: by absolute residuals the constant would be lost in it.
  const std::vector<TimedTerms> measured{
      {{1, 64}, 3.064}, {{1, 1024}, 4.024}, {{1, 16384}, 19.384}, {{1, 1048576}, 1.1 * 1051.576}};
  const LinearFit fit = fit_linear(measured);
  EXPECT_NEAR(fit.first, 3, 0.3);
  EXPECT_LT(fit.worst, 0.1);
  EXPECT_GT(fit.worst, 0.01);
}

TEST(LinearFit, NothingCostsLessThanNothing) {
  const LinearFit falling = fit_linear(std::vector<TimedTerms>{{{1, 0}, 5}, {{1, 10}, 4}});
  EXPECT_GT(falling.first, 0);
  EXPECT_EQ(falling.second, 0);
  const LinearFit steep = fit_linear(std::vector<TimedTerms>{{{1, 10}, 1}, {{1, 20}, 4}});
  EXPECT_EQ(steep.first, 0);
  EXPECT_GT(steep.second, 0);
}

TEST(LinearFit, TermsInProportionAreOneTerm) {
  const LinearFit fit =
      fit_linear(std::vector<TimedTerms>{{{1, 2}, 6}, {{2, 4}, 12}, {{3, 6}, 18}});
  EXPECT_NEAR(fit.at(5, 10), 30, 1e-9);
}

TEST(LinearFit, OfNothingThereIsNothing) {
  const LinearFit fit = fit_linear(std::vector<TimedTerms>{{{1, 1}, 0}});
  EXPECT_EQ(fit.first, 0);
  EXPECT_EQ(fit.second, 0);
}

}  // namespace
}  // namespace goldthread::bench
