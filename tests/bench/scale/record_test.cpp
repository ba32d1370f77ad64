// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/record.h"

#include <gtest/gtest.h>

#include <numeric>

#include "bench/scale/paced_source.h"

namespace goldthread::bench {
namespace {

constexpr ImageSettings kImage{{128, 64}, true, {0, 0, 0}, ColorSpace::kDisplay};
constexpr Casting kEveryPixel{{Sampling::kEveryPixel, 0.5, 1}, Update::kAll};

/// A grey picture, whose rays take 10 field evaluations on the left half and 30 on the right.
class TwoHalves final : public SampleSource {
 public:
  CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                  std::span<std::uint32_t> surfaces) const override {
    CastCounts counts{positions.size(), 0};
    for (const PixelPosition& position : positions) counts.samples += position.x < 64 ? 10 : 30;
    std::fill(samples.begin(), samples.end(), Sample{0.5F, 0.5F, 0.5F, 1});
    std::fill(surfaces.begin(), surfaces.end(), 0U);
    return counts;
  }
};

TEST(Record, AWholePictureHasARayInEachPixel) {
  const CountedView view = count_view(TwoHalves(), kImage, kWholeCasting, 2);
  ASSERT_EQ(view.steps.size(), 1U);
  ASSERT_EQ(view.steps[0].size(), 2U);
  EXPECT_EQ(view.steps[0][0].rays, 4096);
  EXPECT_EQ(view.steps[0][1].samples, 30 * 4096);
  EXPECT_EQ(view.steps[0][0].bytes, 4096 * sizeof(Sample));
  EXPECT_EQ(view.steps[0][0].block_rays, std::vector<std::uint32_t>(16, 256));
  ASSERT_EQ(view.samples_per_ray.size(), 32U);
  EXPECT_EQ(view.samples_per_ray[0], 10);
  EXPECT_EQ(view.samples_per_ray[31], 30);
}

TEST(Record, StepsAreCountedEachForItself) {
  const CountedView view = count_view(TwoHalves(), kImage, kEveryPixel, 1);
  ASSERT_EQ(view.steps.size(), 3U);
  EXPECT_EQ(view.steps[0][0].rays, 25);  // 16 pixels apart, with the replicated row and column
  for (const auto& step : view.steps)
    for (const CountedStep& tile : step)
      EXPECT_EQ(std::accumulate(tile.block_rays.begin(), tile.block_rays.end(), 0.0), tile.rays);
}

TEST(Record, CostsAreCountsTimesPricesWhereTheRaysWere) {
  const CountedView view = count_view(TwoHalves(), kImage, kEveryPixel, 1);
  const std::vector<LinearFit> prices(3, LinearFit{2, 0.5, 0});
  const CostRecord image = cost_record(view, prices);
  EXPECT_EQ(image.columns, 8);
  EXPECT_EQ(image.rows, 4);
  const FrameWork work = work_of(image, view.grid);
  for (std::size_t step = 0; step < 3; ++step)
    for (std::size_t tile = 0; tile < 2; ++tile) {
      const CountedStep& counted = view.steps[step][tile];
      EXPECT_NEAR(work.steps[step][tile].us, 2 * counted.rays + 0.5 * counted.samples, 1e-6);
      EXPECT_NEAR(work.steps[step][tile].bytes, counted.bytes, 1e-6);
    }
  // A ray on the left costs 2 + 5 µs, one on the right 2 + 15; but for those on the border, which
  // see the other half and whose cost all blocks of their tile share.
  EXPECT_NEAR(image.steps[2][0].us / (7 * view.steps[2][0].block_rays[0]), 1, 0.02);
  EXPECT_NEAR(image.steps[2][7].us / (17 * view.steps[2][1].block_rays[3]), 1, 0.02);
}

TEST(Record, PricesOfAStepAddUpToItsTime) {
  CountedView view = count_view(TwoHalves(), kImage, kWholeCasting, 1);
  view.steps[0][0].thread_us = 1000;
  view.steps[0][1].thread_us = 2600;
  const FrameWork work = work_of(cost_record(view, fit_steps(view)), view.grid);
  EXPECT_NEAR(work.us(), 3600, 1e-6);
  EXPECT_NEAR(work.steps[0][1].us, 2600, 1e-6);
}

TEST(PacedSource, RaysCostWhatTheImageSays) {
  CostRecord image{2, 1, {{{1, 0, 0}, {3, 0, 0}}}};
  const PacedSource paced(image, {32, 16}, 5120);  // 512 pixels: 10 µs each
  const PixelPosition left{3.5F, 2.5F}, right{20.5F, 2.5F};
  EXPECT_EQ(paced.count(std::span(&left, 1)).samples, 5000U);
  EXPECT_EQ(paced.count(std::span(&right, 1)).samples, 15000U);
}

}  // namespace
}  // namespace goldthread::bench
