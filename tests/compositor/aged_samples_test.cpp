// SPDX-License-Identifier: Apache-2.0
#include "compositor/aged_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/tile/update_pattern.h"

namespace goldthread {
namespace {

constexpr Update kUpdates[] = {Update::kAll, Update::kHalf, Update::kQuarter, Update::kFrameless};
constexpr PixelRect kRect{16, 32, 37, 21};
using Field = std::function<float(PixelPosition)>;

double at_rest(Epoch) { return 0; }

float waves(PixelPosition p) { return 0.5f + 0.4f * std::sin(p.x * 0.7f) * std::cos(p.y * 0.9f); }

void cast(AgedSamples& into, Update update, std::uint32_t view, std::uint32_t part,
          const Field& field) {
  std::vector<Sample> samples;
  for (const UpdatePlace& place : places_of(into.rect(), update, part)) {
    const float value = field(place.position);
    samples.push_back({value, value / 2, 1 - value, 1});
  }
  ASSERT_TRUE(into.put({view}, part, samples));
}

TEST(AgedSamples, AtRestAllPartsOfDifferentFramesAreTheSameAsAllOfOne) {
  for (const Update update : kUpdates) {
    AgedSamples in_turn(kRect, update), at_once(kRect, update);
    const std::uint32_t parts = parts_of(update);
    for (std::uint32_t i = 0; i < parts; ++i) {
      cast(in_turn, update, i + 1, (i + 3) % parts, waves);
      cast(at_once, update, 1, i, waves);
    }
    EXPECT_EQ(in_turn.picture(at_rest), at_once.picture(at_rest)) << int(update);
  }
}

TEST(AgedSamples, APartialUpdateAtRestIsThePicture) {
  for (const Update update : {Update::kAll, Update::kHalf, Update::kQuarter}) {
    AgedSamples samples(kRect, update);
    for (std::uint32_t part = 0; part < parts_of(update); ++part)
      cast(samples, update, 1, part, waves);
    const auto picture = samples.picture(at_rest);
    std::size_t i = 0;
    for (int y = kRect.y; y < kRect.y + kRect.height; ++y)
      for (int x = kRect.x; x < kRect.x + kRect.width; ++x, ++i)
        EXPECT_EQ(picture[i].red, waves({float(x) + 0.5f, float(y) + 0.5f}));
  }
}

TEST(AgedSamples, ANewerSampleReplacesTheOlderOneAndThoseOfOtherPartsStay) {
  for (const Update update : {Update::kHalf, Update::kQuarter}) {
    AgedSamples samples(kRect, update);
    const std::uint32_t parts = parts_of(update);
    for (std::uint32_t frame = 0; frame < 3 * parts + 1; ++frame) {
      cast(samples, update, frame, frame % parts, [&](PixelPosition) { return float(frame); });
      if (frame < parts) continue;
      const auto picture = samples.picture(at_rest);
      for (std::uint32_t i = 0; i < picture.size(); ++i) {
        const std::uint32_t part = part_of(kRect, update, i);
        const std::uint32_t age = (frame + parts - part) % parts;
        EXPECT_EQ(picture[i].red, float(frame - age));
      }
    }
  }
}

TEST(AgedSamples, WeightsSumToOneWhateverTheAges) {
  for (const Update update : kUpdates) {
    AgedSamples samples(kRect, update);
    for (std::uint32_t part = 0; part < parts_of(update); ++part) {
      cast(samples, update, part, part, [](PixelPosition) { return 0.3f; });
      for (const Sample& pixel : samples.picture([](Epoch view) { return 3.0 * view.value; })) {
        EXPECT_NEAR(pixel.red, 0.3f, 1e-6) << "never black, from the first part on";
        EXPECT_NEAR(pixel.alpha, 1, 1e-6);
      }
    }
  }
}

TEST(AgedSamples, FramelessPixelsLieBetweenTheirSamples) {
  AgedSamples samples(kRect, Update::kFrameless);
  for (std::uint32_t part = 0; part < kFramelessSamples; ++part)
    cast(samples, Update::kFrameless, part, part,
         [&](PixelPosition) { return part % 2 ? 1.0f : 0.0f; });
  const auto still = samples.picture(at_rest);
  const auto odd_fresh = samples.picture([](Epoch view) { return view.value % 2 ? 0.0 : 2.0; });
  double sum_still = 0, sum_fresh = 0;
  for (std::size_t i = 0; i < still.size(); ++i) {
    EXPECT_TRUE(0 < still[i].red && still[i].red < 1);
    EXPECT_GE(odd_fresh[i].red, still[i].red) << "those that moved count for less";
    sum_still += still[i].red;
    sum_fresh += odd_fresh[i].red;
  }
  EXPECT_NEAR(sum_still / double(still.size()), 0.5, 0.05);
  EXPECT_GT(sum_fresh / double(still.size()), 0.98);
}

TEST(AgedSamples, FramelessKeepsALinearRampNearly) {
  AgedSamples ramp(kRect, Update::kFrameless);
  for (std::uint32_t part = 0; part < kFramelessSamples; ++part)
    cast(ramp, Update::kFrameless, 1, part, [](PixelPosition p) { return 0.01f * p.x; });
  const auto picture = ramp.picture(at_rest);
  for (int y = 2; y < kRect.height - 2; ++y)
    for (int x = 2; x < kRect.width - 2; ++x)
      EXPECT_NEAR(picture[std::size_t(y * kRect.width + x)].red,
                  0.01f * (float(kRect.x + x) + 0.5f), 0.005f)
          << "half a pixel at most";
}

TEST(AgedSamples, FramelessSmoothsAnEdgeWhereverItLiesInABlock) {
  double at_edge = 0;
  for (int column = 12; column < 12 + kFramelessBlock; ++column) {
    AgedSamples edge(kRect, Update::kFrameless);
    const float middle = float(kRect.x + column) + 0.5f;
    for (std::uint32_t part = 0; part < kFramelessSamples; ++part)
      cast(edge, Update::kFrameless, 1, part,
           [&](PixelPosition p) { return p.x < middle ? 1 : 0; });
    const auto picture = edge.picture(at_rest);
    for (int y = 0; y < kRect.height; ++y) {
      const auto i = std::size_t(y * kRect.width + column);
      at_edge += double(picture[i].red) / (kRect.height * kFramelessBlock);
      EXPECT_GT(picture[i - 2].red, 0.99f);
      EXPECT_LT(picture[i + 2].red, 0.01f);
    }
  }
  // Twice the standard deviation of the mean of so many places of a sample in its pixel.
  EXPECT_NEAR(at_edge, 0.5, 2 / std::sqrt(12.0 * kFramelessSamples));
}

TEST(AgedSamples, WhatIsNotAPartIsRefused) {
  for (const Update update : kUpdates) {
    AgedSamples samples(kRect, update);
    const auto count = places_of(kRect, update, 0).size();
    EXPECT_FALSE(samples.put({1}, parts_of(update), std::vector<Sample>(count)));
    EXPECT_FALSE(samples.put({1}, 0, std::vector<Sample>(count + 1)));
    EXPECT_FALSE(samples.any());
    EXPECT_TRUE(samples.put({1}, 0, std::vector<Sample>(count)));
    EXPECT_TRUE(samples.any());
  }
}

TEST(AgedSamples, BeforeTheFirstPartThereIsNothing) {
  for (const Update update : kUpdates) {
    const AgedSamples samples(kRect, update);
    for (const Sample& pixel : samples.picture(at_rest)) EXPECT_EQ(pixel, Sample{});
  }
}

TEST(Fading, FallsSteadilyFromOneWithoutMovement) {
  EXPECT_EQ(fading(0), 1);
  EXPECT_DOUBLE_EQ(fading(0.5), 0.5);
  EXPECT_DOUBLE_EQ(fading(1), 1.0 / 17);
  for (double m = 0; m < 600; m += 0.3) {
    EXPECT_GT(fading(m), fading(m + 0.3));
    EXPECT_GT(static_cast<float>(fading(m)), 0);
  }
}

}  // namespace
}  // namespace goldthread
