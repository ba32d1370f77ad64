// SPDX-License-Identifier: Apache-2.0
// A million samples in a pixel do not drift.

#include "worker/refinement/pixel_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "refinement_support.h"

namespace goldthread::test {
namespace {

constexpr std::uint32_t kMillion = 1U << 20;
/// What the header promises of the sums, and the rounding of what is handed out to a float.
constexpr double kBound = 0x1p20 * 0x1p-53 + 0x1p-24;

/// Sums `count` samples of `value_of(i)`, and holds mean and variance against long double.
class Summed {
 public:
  template <class ValueOf>
  Summed(std::uint32_t count, const ValueOf& value_of)
      : sum_({}, 0, sample(value_of(0U)), shown(sample(value_of(0U)), {})) {
    for (std::uint32_t i = 1; i < count; ++i) {
      const Sample next = sample(value_of(i));
      sum_.add(next, shown(next, {}));
    }
    for (std::uint32_t i = 0; i < count; ++i) mean_ += static_cast<long double>(value_of(i));
    mean_ /= count;
    for (std::uint32_t i = 0; i < count; ++i) {
      const long double off = static_cast<long double>(value_of(i)) - mean_;
      squares_ += off * off;
    }
    squares_ /= count - 1;
  }

  const PixelSum& sum() const { return sum_; }
  double relative_error_of_mean() const {
    const auto off = std::abs(static_cast<long double>(sum_.mean().red) - mean_);
    return double(off / mean_);
  }
  /// Two passes.
  long double true_mean() const { return mean_; }
  double true_variance() const { return double(squares_); }

 private:
  static Sample sample(float value) { return {value, value, value, 1}; }

  PixelSum sum_;
  long double mean_ = 0;
  long double squares_ = 0;
};

TEST(PixelSum, TheMeanOfAMillionSamplesDoesNotDrift) {
  Dice dice(1);
  std::vector<float> values(kMillion);
  for (float& value : values) value = static_cast<float>(dice.roll());
  const Summed summed(kMillion, [&](std::uint32_t i) { return values[i]; });
  EXPECT_EQ(summed.sum().count(), kMillion);
  EXPECT_LE(summed.relative_error_of_mean(), kBound);
}

TEST(PixelSum, SmallSamplesAreNotLostBesideLargeOnes) {
  const Summed summed(kMillion, [](std::uint32_t i) { return i % 1024 == 0 ? 1.0F : 1e-7F; });
  EXPECT_LE(summed.relative_error_of_mean(), kBound);
  const Summed late(kMillion, [](std::uint32_t i) { return i == 0 ? 1.0F : 1e-7F; });
  EXPECT_LE(late.relative_error_of_mean(), kBound);
}

TEST(PixelSum, DenormalSamplesAreKept) {
  const float least = std::numeric_limits<float>::denorm_min();
  const Summed summed(kMillion, [&](std::uint32_t i) { return float(1 + i % 3 * 2) * least; });
  // A denormal mean is rounded to a multiple of the least one.
  EXPECT_NEAR(double(summed.sum().mean().red), double(summed.true_mean()), 0.5 * double(least));
  EXPECT_GT(summed.sum().mean().red, 0.0F);
}

TEST(PixelSum, TheMeanOfEqualSamplesIsThatSample) {
  for (const float value : {1.0F, 0.1F, 0.3333333F, 1e-7F, 0x1p-149F, 0x1.fffffep-1F})
    for (const std::uint32_t count : {1U, 3U, 5U, 7U, 1000U, 65537U, kMillion}) {
      const Summed summed(count, [&](std::uint32_t) { return value; });
      EXPECT_EQ(summed.sum().mean(), (Sample{value, value, value, 1})) << value << ", " << count;
      EXPECT_EQ(summed.sum().variance(), 0) << value << ", " << count;
    }
}

TEST(PixelSum, TheVarianceIsThatOfTwoPasses) {
  Dice dice(2);
  std::vector<float> wide(kMillion), narrow(kMillion);
  for (float& value : wide) value = static_cast<float>(dice.roll());
  for (float& value : narrow) value = static_cast<float>(0.5 + 1e-4 * dice.roll());
  for (const auto* values : {&wide, &narrow}) {
    const Summed summed(kMillion, [&](std::uint32_t i) { return (*values)[i]; });
    const double truth = summed.true_variance();
    // Chan, Golub, LeVeque 1983: count · rounding · condition.
    const double condition = std::sqrt(1 + double(summed.true_mean() * summed.true_mean()) / truth);
    EXPECT_NEAR(summed.sum().variance() / truth, 1, kMillion * 0x1p-53 * condition);
  }
}

TEST(PixelSum, TheSameSamplesGiveTheSameBitsHoweverTheyCome) {
  Dice dice(3);
  std::vector<Sample> samples(1000);
  for (Sample& sample : samples) sample = grey(dice.roll());
  const auto sum_of = [&](std::size_t first) {
    PixelSum sum({}, 0, samples[0], shown(samples[0], {}));
    for (std::size_t i = 1; i < first; ++i) sum.add(samples[i], shown(samples[i], {}));
    PixelSum copy = sum;  // as a tile that is left and gone on with
    for (std::size_t i = first; i < samples.size(); ++i)
      copy.add(samples[i], shown(samples[i], {}));
    return copy;
  };
  const PixelSum once = sum_of(1), twice = sum_of(500);
  EXPECT_EQ(once.mean(), twice.mean());
  EXPECT_EQ(once.variance(), twice.variance());
}

TEST(PixelSum, TheMeanOfTheOthersIsWithoutTheFirst) {
  PixelSum sum({}, 0.5, grey(0.9), shown(grey(0.9), {}));
  EXPECT_EQ(sum.mean_of_others().value[0], 0.9F) << "of one sample, that one";
  for (const double value : {0.1, 0.2, 0.3}) sum.add(grey(value), shown(grey(value), {}));
  EXPECT_NEAR(sum.mean_of_others().value[1], 0.2F, 1e-6F);
  EXPECT_EQ(sum.centre().value[2], 0.9F);
}

}  // namespace
}  // namespace goldthread::test
