// SPDX-License-Identifier: Apache-2.0
// Where samples lie in their pixel: stratified, never outside, another way in each pixel; and how
// fast means of them converge.

#include "worker/refinement/sample_sequence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>

#include "refinement_support.h"

namespace goldthread::test {
namespace {

/// The scrambled samples: the first, with the number 0, is the centre.
std::vector<PixelPosition> scrambled(int x, int y, std::uint32_t count) {
  std::vector<PixelPosition> positions;
  for (std::uint32_t number = 1; number <= count; ++number)
    positions.push_back(sample_position(x, y, number));
  return positions;
}

/// Whether each of across × down equal parts of the pixel holds one.
bool one_in_each(const std::vector<PixelPosition>& positions, int x, int y, std::size_t across,
                 std::size_t down) {
  std::vector<int> held(across * down);
  for (const PixelPosition& p : positions) {
    const auto column = static_cast<std::size_t>((double(p.x) - x) * double(across));
    const auto row = static_cast<std::size_t>((double(p.y) - y) * double(down));
    if (column >= across || row >= down) return false;
    ++held[row * across + column];
  }
  return std::all_of(held.begin(), held.end(), [](int count) { return count == 1; });
}

TEST(SamplePosition, TheFirstIsThePixelsCentre) {
  EXPECT_EQ(sample_position(0, 0, 0).x, 0.5F);
  EXPECT_EQ(sample_position(17, 4093, 0).x, 17.5F);
  EXPECT_EQ(sample_position(17, 4093, 0).y, 4093.5F);
}

TEST(SamplePosition, EachPrefixOfAPowerOfTwoHasOneInEachElementaryInterval) {
  // Near the origin, where floats keep positions to 2^-22 and rounding moves none across a border;
  // of many samples, only in the first pixel is that so.
  for (int pixel = 0; pixel < 16; ++pixel)
    for (unsigned bits = 0; bits <= (pixel == 0 ? 12U : 6U); ++bits) {
      const int x = pixel % 4, y = pixel / 4;
      const auto positions = scrambled(x, y, 1U << bits);
      for (unsigned across = 0; across <= bits; ++across)
        EXPECT_TRUE(one_in_each(positions, x, y, std::size_t(1) << across,
                                std::size_t(1) << (bits - across)))
            << "pixel " << x << ", " << y << ": 2^" << across << " × 2^" << bits - across;
    }
}

TEST(SamplePosition, LiesInItsPixelAnywhereInTheLargestImage) {
  Dice dice(1);
  for (int i = 0; i < 200; ++i) {
    const int x = dice.below(1 << 14), y = dice.below(1 << 14);
    for (const PixelPosition& p : scrambled(x, y, 256)) {
      // Rounding may put one on the border.
      EXPECT_TRUE(p.x >= float(x) && p.x <= float(x + 1));
      EXPECT_TRUE(p.y >= float(y) && p.y <= float(y + 1));
    }
  }
}

TEST(SamplePosition, AlmostAllOfThemAreDistinctAtTheFarEdgeOfTheLargestImage) {
  // To 1/1024 pixel there are 2^20 places.
  auto positions = scrambled((1 << 14) - 1, (1 << 14) - 1, 1024);
  std::sort(positions.begin(), positions.end(), [](PixelPosition a, PixelPosition b) {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
  });
  const auto end = std::unique(positions.begin(), positions.end(),
                               [](auto a, auto b) { return a.x == b.x && a.y == b.y; });
  EXPECT_GE(end - positions.begin(), 1022);
}

TEST(SamplePosition, PixelsDiffer) {
  std::vector<std::pair<float, float>> firsts;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const PixelPosition p = sample_position(x, y, 1);
      firsts.emplace_back(p.x - float(x), p.y - float(y));
    }
  // 2^-17 of a pixel is kept at least: two of 4096 agree once in 500 000 pixels or so.
  std::sort(firsts.begin(), firsts.end());
  EXPECT_EQ(std::unique(firsts.begin(), firsts.end()) - firsts.begin(), 4096);
  // Nor do they follow a pattern: over the pixels each first sample is uniform.
  double mean_x = 0, mean_y = 0, product = 0;
  for (const auto& [x, y] : firsts) {
    mean_x += double(x) / 4096;
    mean_y += double(y) / 4096;
    product += (double(x) - 0.5) * (double(y) - 0.5) * 12 / 4096;
  }
  const double three_sigma = 3 / std::sqrt(12.0 * 4096);
  EXPECT_NEAR(mean_x, 0.5, three_sigma);
  EXPECT_NEAR(mean_y, 0.5, three_sigma);
  EXPECT_NEAR(product, 0, 3.0 / 64);
}

TEST(SamplePosition, DependsOnNothingButThePixelAndTheNumber) {
  const PixelPosition late = sample_position(5, 7, 1U << 20);
  scrambled(5, 7, 100);
  EXPECT_EQ(sample_position(5, 7, 1U << 20).x, late.x);
  EXPECT_EQ(sample_position(5, 7, 1U << 20).y, late.y);
}

/// A function over the unit square with its mean.
struct Integrand {
  std::function<double(double x, double y)> at;
  double mean = 0;
};

/// What lies on one side of a line through the middle of the pixel's surroundings; its mean by a
/// fine grid.
Integrand random_edge(Dice& dice) {
  const double angle = dice.between(0, 2 * M_PI);
  const double nx = std::cos(angle), ny = std::sin(angle);
  const double off = nx * dice.roll() + ny * dice.roll();
  Integrand edge;
  edge.at = [=](double x, double y) { return nx * x + ny * y > off ? 1.0 : 0.0; };
  // Along x the area is exact, along y the midpoint rule of a piecewise linear function.
  constexpr int kRows = 1 << 14;
  for (int j = 0; j < kRows; ++j) {
    const double x = std::clamp((off - ny * (j + 0.5) / kRows) / nx, 0.0, 1.0);
    edge.mean += (nx > 0 ? 1 - x : x) / kRows;
  }
  return edge;
}

Integrand random_wave(Dice& dice) {
  const double a = dice.between(0.5, 2), b = dice.between(0.5, 2), phase = dice.between(0, 6);
  Integrand wave;
  wave.at = [=](double x, double y) { return std::sin(a * x + phase) * std::exp(b * y); };
  wave.mean = (std::cos(phase) - std::cos(a + phase)) / a * (std::exp(b) - 1) / b;
  return wave;
}

/// The exponent p of RMS = C · n^p, by least squares over n = 4, 16, 64, 256, 1024.
double order_of(const std::function<Integrand(Dice&)>& random) {
  constexpr int kPixels = 500;
  Dice dice(9);
  std::vector<double> squared(6);
  for (int i = 0; i < kPixels; ++i) {
    const int x = i % 32, y = i / 32;
    const Integrand integrand = random(dice);
    const auto positions = scrambled(x, y, 1024);
    double sum = 0;
    std::size_t held = 0;
    for (unsigned k = 1; k <= 5; ++k) {
      for (; held < (std::size_t(1) << (2 * k)); ++held)
        sum += integrand.at(double(positions[held].x) - x, double(positions[held].y) - y);
      const double off = sum / double(held) - integrand.mean;
      squared[k] += off * off / kPixels;
    }
  }
  double products = 0;
  for (unsigned k = 1; k <= 5; ++k) {
    products += (k - 3.0) * 0.5 * std::log(squared[k]);
    std::printf("  %4d samples: RMS %.3g\n", 1 << (2 * k), std::sqrt(squared[k]));
  }
  return products / 10 / std::log(4.0);
}

TEST(SamplePosition, MeansAtAnEdgeConvergeLikeThreeQuarters) {
  const double order = order_of(random_edge);
  std::printf("  order %.3f\n", order);
  EXPECT_NEAR(order, -0.75, 0.05);
}

TEST(SamplePosition, MeansOfWhatIsSmoothConvergeFasterThanFirstOrder) {
  const double order = order_of(random_wave);
  std::printf("  order %.3f\n", order);
  EXPECT_LT(order, -1.2);
}

}  // namespace
}  // namespace goldthread::test
