// SPDX-License-Identifier: Apache-2.0
#include "compositor/reconstruct.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace goldthread {
namespace {

using Field = std::function<Sample(double x, double y)>;  // of pixel centres

void place(SampleArray& array, TileId tile, Level from, Level to, const Field& field) {
  const PixelRect rect = array.grid().rect(tile);
  std::vector<Sample> samples;
  for (const auto offset : new_samples({rect.width, rect.height}, from, to)) {
    const PixelPosition position = position_of(rect, offset);
    samples.push_back(field(position.x, position.y));
  }
  ASSERT_TRUE(array.place(tile, from, to, samples));
}

/// Every tile at one level.
SampleArray sampled(const TileGrid& grid, Level level, const Field& field) {
  SampleArray array(grid, band_of(grid, 0, 1));
  for (std::uint32_t i = 0; i < grid.count(); ++i) place(array, {i}, kNoLevel, level, field);
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

TEST(Reconstruct, AtThePixelLevelGivesExactlyTheSamplesOverTheBackground) {
  const TileGrid grid = TileGrid::squares({100, 70}, 64);
  const Field field = [](double x, double y) {
    return Sample{float(x) * 0.001f, float(y) * 0.003f, 0.1f, float(x) / 128};
  };
  const glm::dvec3 background{0.25, 0.5, 1};
  for_each_pixel(grid, reconstruct(sampled(grid, kPixelLevel, field), background),
                 [&](int x, int y, const float* pixel) {
                   const Sample s = field(x + 0.5, y + 0.5);
                   const float clear = 1 - s.alpha;
                   ASSERT_EQ(pixel[0], s.red + clear * 0.25f);
                   ASSERT_EQ(pixel[1], s.green + clear * 0.5f);
                   ASSERT_EQ(pixel[2], s.blue + clear * 1.0f);
                   ASSERT_EQ(pixel[3], s.alpha);
                 });
}

TEST(Reconstruct, ReproducesLinearFunctionsExactlyAtEveryLevelAndTileSize) {
  for (const TileGrid& grid : {TileGrid::squares({100, 70}, 64), TileGrid::squares({33, 17}, 16),
                               TileGrid::rows_of({50, 40})}) {
    for (std::int8_t log2 = 0; log2 <= 4; ++log2) {
      for_each_pixel(grid, reconstruct(sampled(grid, {log2}, linear), kBlack),
                     [&](int x, int y, const float* pixel) {
                       const Sample s = linear(x + 0.5, y + 0.5);
                       ASSERT_EQ(pixel[0], s.red) << x << " " << y << " level " << int(log2);
                       ASSERT_EQ(pixel[1], s.green);
                       ASSERT_EQ(pixel[2], s.blue);
                       ASSERT_EQ(pixel[3], 1);
                     });
    }
  }
}

double rms_error(const TileGrid& grid, Level level, const Field& field) {
  double sum = 0;
  for_each_pixel(grid, reconstruct(sampled(grid, level, field), kBlack),
                 [&](int x, int y, const float* pixel) {
                   const double error = double(pixel[0]) - double(field(x + 0.5, y + 0.5).red);
                   sum += error * error;
                 });
  return std::sqrt(sum / (grid.image.width * grid.image.height));
}

TEST(Reconstruct, ConvergesWithTheSquareOfTheSpacing) {
  const TileGrid grid = TileGrid::squares({256, 256}, 64);
  // From 16 to 4 pixels: below, the pixels are too few of a square to show its mean error.
  for (std::int8_t log2 = 4; log2 > 2; --log2) {
    const double coarse = rms_error(grid, {log2}, smooth);
    const double fine = rms_error(grid, {static_cast<std::int8_t>(log2 - 1)}, smooth);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.15) << "from level " << int(log2);
  }
}

TEST(Reconstruct, LeavesNoHoleBetweenTilesAtDifferentLevels) {
  const TileGrid grid = TileGrid::squares({192, 192}, 64);
  SampleArray array(grid, band_of(grid, 0, 1));
  for (std::uint32_t i = 0; i < grid.count(); ++i) {
    place(array, {i}, kNoLevel, {static_cast<std::int8_t>(i % 5)}, linear);
  }
  for_each_pixel(grid, reconstruct(array, kBlack), [](int x, int y, const float* pixel) {
    ASSERT_EQ(pixel[0], linear(x + 0.5, y + 0.5).red) << x << " " << y;
  });
}

TEST(Reconstruct, ShowsTheBackgroundWhereATileHasNothingYet) {
  const TileGrid grid = TileGrid::squares({128, 64}, 64);
  SampleArray array(grid, band_of(grid, 0, 1));
  place(array, {0}, kNoLevel, kCoarsestLevel, linear);
  place(array, {1}, {4}, {3}, linear);  // without the coarser level it counts as nothing
  for_each_pixel(grid, reconstruct(array, {0.25, 0.5, 0.75}), [](int x, int, const float* pixel) {
    if (x < 64) return;
    ASSERT_EQ(pixel[0], 0.25f);
    ASSERT_EQ(pixel[1], 0.5f);
    ASSERT_EQ(pixel[2], 0.75f);
    ASSERT_EQ(pixel[3], 0);
  });
}

TEST(Reconstruct, GivesEachBandItsRowsOfThePicture) {
  const TileGrid grid = TileGrid::squares({100, 150}, 32);
  const auto whole = reconstruct(sampled(grid, {2}, smooth), kBlack);
  std::vector<float> joined;
  for (int i = 0; i < 7; ++i) {
    const Band band = band_of(grid, i, 7);
    SampleArray array(grid, band);
    const auto columns = static_cast<std::uint32_t>(grid.columns());
    for (auto tile = std::uint32_t(band.first_row) * columns;
         tile < std::uint32_t(band.last_row) * columns; ++tile) {
      place(array, {tile}, kNoLevel, {2}, smooth);
    }
    const auto part = reconstruct(array, kBlack);
    joined.insert(joined.end(), part.begin(), part.end());
  }
  EXPECT_EQ(joined, whole) << "to the bit";
}

TEST(EstimatedError, IsZeroForLinearFunctions) {
  for (std::int8_t log2 = 0; log2 <= 4; ++log2) {
    const auto array = sampled(TileGrid::squares({200, 100}, 64), {log2}, linear);
    EXPECT_EQ(estimate_squared_error(array), 0) << int(log2);
  }
}

TEST(EstimatedError, OfNoSamplesIsZero) {
  const TileGrid grid = TileGrid::squares({64, 64}, 64);
  EXPECT_EQ(estimate_squared_error({grid, band_of(grid, 0, 1)}), 0);
}

TEST(EstimatedError, FallsWithTheFourthPowerOfTheSpacingWhereThePictureIsSmooth) {
  const TileGrid grid = TileGrid::squares({256, 256}, 64);
  for (std::int8_t log2 = 3; log2 > 1; --log2) {
    const double coarse = estimate_squared_error(sampled(grid, {log2}, smooth));
    const double fine =
        estimate_squared_error(sampled(grid, {static_cast<std::int8_t>(log2 - 1)}, smooth));
    EXPECT_NEAR(std::log2(coarse / fine), 4, 0.3) << "from level " << int(log2);
  }
}

TEST(EstimatedError, IsNotZeroForATileOfTwoSpacings) {
  // Of the tile's own samples no three lie in a row; with the replicated ones they do.
  const auto array = sampled(TileGrid::squares({128, 128}, 32), kCoarsestLevel, smooth);
  EXPECT_GT(estimate_squared_error(array), 0);
}

}  // namespace
}  // namespace goldthread
