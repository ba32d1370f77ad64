// SPDX-License-Identifier: Apache-2.0
#include "common/image/display.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "common/image/color.h"

namespace goldthread {
namespace {

std::uint8_t shown(float value, ColorSpace space) {
  const float rgba[4]{value, value, value, 1};
  const auto rgb = display_rgb8(rgba, space);
  EXPECT_EQ(rgb.size(), 3u);
  EXPECT_EQ(rgb[0], rgb[1]);
  EXPECT_EQ(rgb[1], rgb[2]);
  return rgb[0];
}

TEST(Display, KeepsTheOrderOfPixelsAndChannelsAndDropsAlpha) {
  const float rgba[8]{0, 0.2f, 0.4f, 0.9f, 0.6f, 0.8f, 1, 0};
  EXPECT_EQ(display_rgb8(rgba, ColorSpace::kDisplay),
            (std::vector<std::uint8_t>{0, 51, 102, 153, 204, 255}));
  EXPECT_TRUE(display_rgb8({}, ColorSpace::kDisplay).empty());
}

TEST(Display, GivesEach8BitValueBack) {
  for (int level = 0; level < 256; ++level) {
    EXPECT_EQ(shown(static_cast<float>(level) / 255, ColorSpace::kDisplay), level);
    const double linear = linear_from_srgb(level / 255.0);
    EXPECT_EQ(shown(static_cast<float>(linear), ColorSpace::kLinear), level);
  }
}

TEST(Display, RoundsToTheNearest) {
  std::mt19937 random(1);
  for (int i = 0; i < 100000; ++i) {
    const float value = std::uniform_real_distribution<float>(-0.1f, 1.1f)(random);
    const double exact = 255 * std::min(1.0, std::max(0.0, static_cast<double>(value)));
    // Half a level, and what a float's rounding may add to it.
    ASSERT_LE(std::abs(shown(value, ColorSpace::kDisplay) - exact), 0.5 + 2e-5) << value;
  }
}

TEST(Display, ClampsWhatIsOutsideAndShowsNanAsBlack) {
  const float infinity = std::numeric_limits<float>::infinity();
  for (const ColorSpace space : {ColorSpace::kDisplay, ColorSpace::kLinear}) {
    EXPECT_EQ(shown(-1, space), 0);
    EXPECT_EQ(shown(-infinity, space), 0);
    EXPECT_EQ(shown(2, space), 255);
    EXPECT_EQ(shown(infinity, space), 255);
    EXPECT_EQ(shown(std::nanf(""), space), 0);
  }
}

TEST(Display, IsTheCurveAndTheRoundingExactlyAroundEachThreshold) {
  for (int level = 0; level < 256; ++level) {
    const double middle = (level + 0.5) / 255;
    const auto around = [&](double threshold, ColorSpace space, const auto& exact) {
      auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(threshold)) - 300;
      for (int i = 0; i < 600; ++i, ++bits) {
        const auto value = std::bit_cast<float>(bits);
        ASSERT_EQ(shown(value, space), exact(value)) << value;
      }
    };
    around(middle, ColorSpace::kDisplay,
           [](float value) { return static_cast<int>(std::lround(std::min(value, 1.0f) * 255)); });
    around(linear_from_srgb(middle), ColorSpace::kLinear,
           [](float value) { return int{to_8_bits(srgb_from_linear(double(value)))}; });
  }
}

TEST(Display, IsTheCurveExactlyForAnyFloat) {
  std::mt19937 random(2);
  for (int i = 0; i < 300000; ++i) {
    const auto value = std::bit_cast<float>(static_cast<std::uint32_t>(random()) >> 2);
    ASSERT_EQ(shown(value, ColorSpace::kLinear), to_8_bits(srgb_from_linear(double(value))))
        << value;
  }
}

TEST(Display, OfManyPixelsIsThatOfEach) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> values(-0.5f, 1.5f);
  for (std::size_t pixels = 1; pixels < 70; ++pixels) {
    std::vector<float> rgba(4 * pixels);
    for (float& value : rgba) value = values(random);
    for (const ColorSpace space : {ColorSpace::kDisplay, ColorSpace::kLinear}) {
      std::vector<std::uint8_t> each;
      for (std::size_t i = 0; i < pixels; ++i)
        for (std::size_t c = 0; c < 3; ++c) each.push_back(shown(rgba[4 * i + c], space));
      ASSERT_EQ(display_rgb8(rgba, space), each) << pixels;
    }
  }
}

}  // namespace
}  // namespace goldthread
