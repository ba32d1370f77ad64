// SPDX-License-Identifier: Apache-2.0
#include "master/stop_rule.h"

#include <gtest/gtest.h>

namespace goldthread {
namespace {

constexpr double kPixels = 100;

/// The sum of squares of pixels that are all off by `error`/255.
TileQuality off_by(double error) { return {kPixels * (error / 255) * (error / 255), 0}; }

StopRule rule(Sampling sampling, double error, std::uint32_t samples = 0) {
  return {sampling, error, samples};
}

TEST(StopRule, SaysHowTheWorkersAreToRefine) {
  for (const Sampling sampling :
       {Sampling::kAdaptive, Sampling::kSubdivision, Sampling::kEveryPixel}) {
    EXPECT_EQ(refinement_of(rule(sampling, 1)).sampling, sampling);
    EXPECT_EQ(refinement_of(rule(sampling, 1)).most_samples, Refinement{}.most_samples);
    EXPECT_EQ(refinement_of(rule(sampling, 1, 7)).most_samples, 7u);
  }
}

TEST(RmsError, OfPixelsThatAreAllOffByTheSameIsThat) {
  EXPECT_DOUBLE_EQ(rms_error(off_by(1).squared_error, kPixels), 1);
  EXPECT_DOUBLE_EQ(rms_error(off_by(0.25).squared_error, kPixels), 0.25);
  EXPECT_DOUBLE_EQ(rms_error(off_by(1).squared_error, 4 * kPixels), 0.5);
}

TEST(StopRule, HoldsWhenTheErrorIsSmallEnough) {
  for (const Sampling sampling : {Sampling::kAdaptive, Sampling::kSubdivision}) {
    EXPECT_FALSE(is_enough(rule(sampling, 0.5), {7}, off_by(0.51), 1000000, kPixels));
    EXPECT_TRUE(is_enough(rule(sampling, 0.5), {7}, off_by(0.49), 0, kPixels));
  }
}

TEST(StopRule, DoesNotTrustTheCoarseSteps) {
  const StopRule adaptive = rule(Sampling::kAdaptive, 0.5);
  EXPECT_FALSE(is_enough(adaptive, {1}, off_by(0), 0, kPixels));
  EXPECT_FALSE(is_enough(adaptive, {2}, off_by(0), 0, kPixels));
  EXPECT_TRUE(is_enough(adaptive, kFirstAdaptiveStep, off_by(0), 0, kPixels));
}

TEST(StopRule, HoldsWhenThereAreAsManySamplesAsWanted) {
  const StopRule four = rule(Sampling::kAdaptive, 0.01, 4);
  EXPECT_FALSE(is_enough(four, {7}, off_by(9), 399, kPixels));
  EXPECT_TRUE(is_enough(four, {7}, off_by(9), 400, kPixels));
  EXPECT_TRUE(is_enough(four, {7}, off_by(0.001), 10, kPixels)) << "or the error is small enough";
}

TEST(StopRule, OfEveryPixelHoldsWithTheStepThatBringsTheLastSample) {
  // Steps bring 1, 5, 9, 17, … samples to each pixel.
  const std::pair<std::uint32_t, Step> expected[] = {{0, {3}},  {1, {3}},  {2, {4}},
                                                     {5, {4}},  {6, {5}},  {9, {5}},
                                                     {10, {6}}, {17, {6}}, {1U << 20, {22}}};
  for (const auto& [samples, last] : expected) {
    const StopRule even = rule(Sampling::kEveryPixel, 0.5, samples);
    for (Step step{1}; step <= last; step = step.next())
      EXPECT_EQ(is_enough(even, step, off_by(9), 0, kPixels), step == last)
          << samples << " samples, step " << step.value;
  }
}

TEST(StopRule, OfEveryPixelCountsNeitherErrorsNorRays) {
  // Few pixels have more rays around them than in them.
  const StopRule even = rule(Sampling::kEveryPixel, 0.5, 4);
  EXPECT_FALSE(is_enough(even, {1}, off_by(0), 1000000, kPixels));
  EXPECT_FALSE(is_enough(even, {3}, off_by(0), 1000000, kPixels));
  EXPECT_TRUE(is_enough(even, {4}, off_by(9), 0, kPixels));
}

TEST(StopRule, HoldsAfterTheLastStepOfAll) {
  const Step before{static_cast<std::uint16_t>(kLastStep.value - 1)};
  const StopRule strict = rule(Sampling::kAdaptive, 0.01);
  EXPECT_FALSE(is_enough(strict, before, off_by(9), 1000000, kPixels));
  EXPECT_TRUE(is_enough(strict, kLastStep, off_by(9), 1000000, kPixels));
}

}  // namespace
}  // namespace goldthread
