// SPDX-License-Identifier: Apache-2.0
#include "compositor/reconstruct.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "common/image/display.h"
#include "tests/compositor/packed_samples.h"

namespace goldthread {
namespace {

using Field = std::function<Sample(double x, double y)>;  // of pixel centres

constexpr Filter kFilters[] = {Filter::kBox, Filter::kBilinear, Filter::kBiquadratic,
                               Filter::kPiecewiseQuadratic, Filter::kBicubic};

void place(SampleArray& array, TileId tile, Step from, Step to, const Field& field) {
  ASSERT_TRUE(array.place(
      packed_grid(array.grid(), tile, from, to, [&](float x, float y) { return field(x, y); })));
}

/// Every tile with the grid of one step alone.
SampleArray sampled(const TileGrid& grid, Step step, const Field& field) {
  SampleArray array(grid, band_of(grid, 0, 1));
  for (std::uint32_t i = 0; i < grid.count(); ++i) place(array, {i}, kNoStep, step, field);
  return array;
}

constexpr glm::dvec3 kBlack{0, 0, 0};

/// Opaque; its coefficients are dyadic, so that each interpolation is exact in floats.
Sample linear(double x, double y) {
  return {static_cast<float>(x / 64 + y / 128), static_cast<float>(1 - x / 256),
          static_cast<float>(y / 32), 1};
}
Sample smooth(double x, double y) {
  const double value = 0.5 + 0.5 * std::sin(0.04 * x) * std::cos(0.05 * y);
  return {static_cast<float>(value), static_cast<float>(0.5 * value), 0.25f, 1};
}

template <class Check>
void for_each_pixel(const TileGrid& grid, const std::vector<float>& pixels, Check check) {
  ASSERT_EQ(pixels.size(), 4 * std::size_t(grid.image.width) * std::size_t(grid.image.height));
  for (int y = 0; y < grid.image.height; ++y) {
    for (int x = 0; x < grid.image.width; ++x) {
      check(x, y, &pixels[4 * (std::size_t(y) * std::size_t(grid.image.width) + std::size_t(x))]);
    }
  }
}

TEST(Reconstruct, OfEveryPixelGivesExactlyTheSamplesOverTheBackgroundWhateverTheFilter) {
  const TileGrid grid = TileGrid::squares({100, 70}, 64);
  const Field field = [](double x, double y) {
    return Sample{float(x) * 0.001f, float(y) * 0.003f, 0.1f, float(x) / 128};
  };
  for (const Filter filter : kFilters) {
    for_each_pixel(grid, reconstruct(sampled(grid, kPixelStep, field), filter, {0.25, 0.5, 1}),
                   [&](int x, int y, const float* pixel) {
                     const Sample s = field(x + 0.5, y + 0.5);
                     const float clear = 1 - s.alpha;
                     ASSERT_EQ(pixel[0], s.red + clear * 0.25f);
                     ASSERT_EQ(pixel[1], s.green + clear * 0.5f);
                     ASSERT_EQ(pixel[2], s.blue + clear * 1.0f);
                     ASSERT_EQ(pixel[3], s.alpha);
                   });
  }
}

TEST(Reconstruct, KeepsARaysResultWhereverOneWasCast) {
  // Some pixels of a tile have rays of their own, as adaptive sampling leaves it.
  const TileGrid grid = TileGrid::squares({64, 64}, 64);
  const Sample own{0.125f, 0.5f, 0.75f, 1};
  for (const Filter filter : kFilters) {
    SampleArray array = sampled(grid, {1}, smooth);
    ASSERT_TRUE(array.place(packed({0}, {1}, {2}, {{5, 7}, {16, 32}}, {own, own})));
    const auto pixels = reconstruct(array, filter, kBlack);
    for (const std::size_t at : {std::size_t{7 * 64 + 5}, std::size_t{32 * 64 + 16}}) {
      EXPECT_EQ(pixels[4 * at], own.red);
      EXPECT_EQ(pixels[4 * at + 1], own.green);
      EXPECT_EQ(pixels[4 * at + 2], own.blue);
    }
  }
}

TEST(Reconstruct, FillsEachHoleByTheFilterThatIsAskedFor) {
  const TileGrid grid = TileGrid::squares({64, 64}, 64);
  const SampleArray array = sampled(grid, {1}, smooth);
  const auto box = reconstruct(array, Filter::kBox, kBlack);
  const auto bilinear = reconstruct(array, Filter::kBilinear, kBlack);
  const auto bicubic = reconstruct(array, Filter::kBicubic, kBlack);
  EXPECT_EQ(box[4 * 8], smooth(0.5, 0.5).red) << "a block's colour is its upper left sample's";
  EXPECT_EQ(bilinear[4 * 8], (smooth(0.5, 0.5).red + smooth(16.5, 0.5).red) / 2);
  EXPECT_NE(bicubic[4 * 8], bilinear[4 * 8]);
  EXPECT_EQ(reconstruct(array, Filter::kBiquadratic, kBlack), bilinear)
      << "halfway between two samples they say the same";
}

TEST(Reconstruct, ReproducesLinearFunctionsExactlyAtEverySpacingAndTileSize) {
  for (const TileGrid& grid : {TileGrid::squares({100, 70}, 64), TileGrid::squares({33, 17}, 16),
                               TileGrid::rows_of({50, 40})}) {
    for (Step step{1}; step <= kPixelStep; step = step.next()) {
      for_each_pixel(grid, reconstruct(sampled(grid, step, linear), Filter::kBilinear, kBlack),
                     [&](int x, int y, const float* pixel) {
                       const Sample s = linear(x + 0.5, y + 0.5);
                       ASSERT_EQ(pixel[0], s.red) << x << " " << y << " step " << step.value;
                       ASSERT_EQ(pixel[1], s.green);
                       ASSERT_EQ(pixel[2], s.blue);
                       ASSERT_EQ(pixel[3], 1);
                     });
    }
  }
}

double rms_error(const TileGrid& grid, Step step, const Field& field) {
  double sum = 0;
  for_each_pixel(grid, reconstruct(sampled(grid, step, field), Filter::kBilinear, kBlack),
                 [&](int x, int y, const float* pixel) {
                   const double error = double(pixel[0]) - double(field(x + 0.5, y + 0.5).red);
                   sum += error * error;
                 });
  return std::sqrt(sum / (grid.image.width * grid.image.height));
}

TEST(Reconstruct, ConvergesWithTheSquareOfTheSpacing) {
  const TileGrid grid = TileGrid::squares({256, 256}, 64);
  // From 16 to 4 pixels: below, the pixels are too few of a square to show its mean error.
  for (Step step{1}; step < Step{3}; step = step.next()) {
    const double coarse = rms_error(grid, step, smooth);
    const double fine = rms_error(grid, step.next(), smooth);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.15) << "from step " << step.value;
  }
}

TEST(Reconstruct, LeavesNoHoleBetweenTilesAtDifferentSteps) {
  const TileGrid grid = TileGrid::squares({192, 192}, 64);
  SampleArray array(grid, band_of(grid, 0, 1));
  for (std::uint32_t i = 0; i < grid.count(); ++i)
    place(array, {i}, kNoStep, {static_cast<std::uint16_t>(1 + i % 5)}, linear);
  for_each_pixel(grid, reconstruct(array, Filter::kBilinear, kBlack),
                 [](int x, int y, const float* pixel) {
                   ASSERT_EQ(pixel[0], linear(x + 0.5, y + 0.5).red) << x << " " << y;
                 });
}

TEST(Reconstruct, ShowsTheBackgroundWhereATileHasNothingYet) {
  const TileGrid grid = TileGrid::squares({192, 64}, 64);
  const Sample own{0.125f, 0.25f, 0.5f, 1};
  SampleArray array(grid, band_of(grid, 0, 1));
  place(array, {0}, kNoStep, {1}, linear);
  // What came before the coarse samples cannot fill in anything, but is shown.
  ASSERT_TRUE(array.place(packed({2}, {2}, {3}, {{5, 0}}, {own})));
  for (const Filter filter : kFilters) {
    const auto pixels = reconstruct(array, filter, {0.25, 0.5, 0.75});
    for_each_pixel(grid, pixels, [&](int x, int y, const float* pixel) {
      if (x < 64) return;
      const bool cast = x == 128 + 5 && y == 0;
      ASSERT_EQ(pixel[0], cast ? own.red : 0.25f);
      ASSERT_EQ(pixel[1], cast ? own.green : 0.5f);
      ASSERT_EQ(pixel[2], cast ? own.blue : 0.75f);
      ASSERT_EQ(pixel[3], cast ? 1 : 0);
    });
  }
}

TEST(Reconstruct, GivesEachBandItsRowsOfThePicture) {
  const TileGrid grid = TileGrid::squares({100, 150}, 32);
  for (const Filter filter : kFilters) {
    const auto whole = reconstruct(sampled(grid, {3}, smooth), filter, kBlack);
    std::vector<float> joined;
    for (int i = 0; i < 7; ++i) {
      const Band band = band_of(grid, i, 7);
      SampleArray array(grid, band);
      const auto columns = static_cast<std::uint32_t>(grid.columns());
      for (auto tile = std::uint32_t(band.first_row) * columns;
           tile < std::uint32_t(band.last_row) * columns; ++tile) {
        place(array, {tile}, kNoStep, {3}, smooth);
      }
      const auto part = reconstruct(array, filter, kBlack);
      joined.insert(joined.end(), part.begin(), part.end());
    }
    EXPECT_EQ(joined, whole) << "to the bit";
  }
}

TEST(Reconstruct, WhatIsShownIsThePictureIn8Bits) {
  const TileGrid grid = TileGrid::squares({100, 70}, 64);
  const Field field = [](double x, double y) {
    return Sample{float(std::sin(x)), float(1.5 * std::cos(0.1 * y)), 0.1f, float(x) / 128};
  };
  std::vector<SampleArray> arrays;
  for (const Step step : {Step{1}, Step{3}, kPixelStep})
    arrays.push_back(sampled(grid, step, field));
  arrays.emplace_back(grid, band_of(grid, 0, 1));  // without any sample
  arrays.emplace_back(grid, band_of(grid, 0, 1));
  place(arrays.back(), {1}, {2}, {3}, field);  // without the coarsest ones
  std::vector<std::uint8_t> rgb;               // one memory for all
  for (const SampleArray& array : arrays)
    for (const Filter filter : kFilters)
      for (const ColorSpace space : {ColorSpace::kDisplay, ColorSpace::kLinear}) {
        const glm::dvec3 background{0.25, 0.5, 0.75};
        reconstruct_shown(array, filter, background, space, rgb);
        ASSERT_EQ(rgb, display_rgb8(reconstruct(array, filter, background), space));
      }
}

}  // namespace
}  // namespace goldthread
