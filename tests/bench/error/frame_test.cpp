// SPDX-License-Identifier: Apache-2.0
#include "bench/error/frame.h"

#include <gtest/gtest.h>

#include <atomic>

#include "bench/error/bench_error.h"
#include "bench/error/references.h"
#include "bench/error/rounds.h"
#include "small_subject.h"

namespace goldthread::bench {
namespace {

/// Tells of each position where it is.
class PositionSource final : public SampleSource {
 public:
  CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                  std::span<std::uint32_t>) const override {
    for (std::size_t i = 0; i < positions.size(); ++i)
      samples[i] = {positions[i].x / 1000, positions[i].y / 1000, 0, 1};
    return {positions.size(), 2 * positions.size()};
  }
};

TEST(BenchFrame, EachPixelIsCastOnceAndFoundInItsPlace) {
  for (const int threads : {1, 3}) {
    FrameCaster caster({150, 70}, threads);
    const CastCounts counts = caster.cast(PositionSource());
    EXPECT_EQ(counts.rays, 150u * 70u);
    EXPECT_EQ(counts.samples, 2u * 150u * 70u);
    const Subset subset{{150, 70}, 4};
    const auto shown = caster.shown({}, 4);
    ASSERT_EQ(shown.size(), subset.count());
    for (std::size_t i = 0; i < shown.size(); ++i) {
      EXPECT_FLOAT_EQ(float(shown[i].r), subset.centre(i).x / 1000);
      EXPECT_FLOAT_EQ(float(shown[i].g), subset.centre(i).y / 1000);
    }
  }
}

TEST(BenchFrame, ASubsetTakesEveryNthPixelFromTheFirst) {
  const Subset subset{{10, 5}, 4};
  EXPECT_EQ(subset.count(), 6u);
  EXPECT_EQ(subset.centre(0).x, 0.5F);
  EXPECT_EQ(subset.centre(5).x, 8.5F);
  EXPECT_EQ(subset.centre(5).y, 4.5F);
}

TEST(BenchFrame, WorkInParallelIsDoneOnceEach) {
  std::vector<std::atomic<int>> done(1000);
  in_parallel(4, done.size(), [&](std::size_t i) { ++done[i]; });
  for (const auto& count : done) EXPECT_EQ(count, 1);
}

TEST(BenchFrame, ThinningKeepsEveryNthPixelOfASubset) {
  std::vector<Color> picture;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x) picture.emplace_back(x, y, 0);
  const auto thin = thinned(picture, {{20, 12}, 4}, 2);
  ASSERT_EQ(thin.size(), 6u);
  EXPECT_EQ(thin[1], Color(2, 0, 0));
  EXPECT_EQ(thin[5], Color(4, 2, 0));
}

TEST(BenchFrame, TheRayCasterConvergesToTheReference) {
  const Subject subject = test::ball_subject("bench_frame");
  ErrorBenchSettings settings;
  settings.stride = 2;
  References references(subject, settings);
  FrameCaster caster(subject.scene.image.size, 1);
  for (const Look look : kLooks) {
    OwnMethod method(subject.in(look, 0.125), subject.volume);
    method.frame_seconds(caster);
    const auto shown = caster.shown(subject.scene.image, settings.stride);
    EXPECT_LT(picture_error(shown, references.of(look)).rms, 0.5) << name_of(look);
  }
  EXPECT_EQ(references.rows().size(), kLooks.size());
  for (const ReferenceRow& row : references.rows()) EXPECT_LE(row.doubled, row.halved);
}

TEST(BenchFrame, AMovedPictureIsAlignedAgain) {
  const Subject subject = test::ball_subject("bench_alignment");
  ErrorBenchSettings settings;
  settings.stride = 1;
  References references(subject, settings);
  const Shift moved{-0.5, 1};
  const Alignment found = references.align(Look::kUnlit, references.moved(Look::kUnlit, moved));
  EXPECT_EQ(found.shift, moved);
  EXPECT_EQ(found.error.rms, 0);
}

}  // namespace
}  // namespace goldthread::bench
