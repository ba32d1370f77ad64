// SPDX-License-Identifier: Apache-2.0
#include "common/tile/filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

namespace goldthread {
namespace {

constexpr Filter kFilters[] = {Filter::kBox, Filter::kBilinear, Filter::kBiquadratic,
                               Filter::kPiecewiseQuadratic, Filter::kBicubic};
using Field = std::function<double(double x, double y)>;

SourceWindow whole(ImageSize size) { return {0, 0, double(size.width), double(size.height)}; }

/// The field at pixel centres of a picture that shows 0 … 1 in both directions.
std::vector<float> picture_of(ImageSize size, const Field& field) {
  std::vector<float> rgba;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double value = field((x + 0.5) / size.width, (y + 0.5) / size.height);
      for (int c = 0; c < 4; ++c) rgba.push_back(static_cast<float>(value / (c + 1)));
    }
  }
  return rgba;
}

/// The greatest error of red, `margin` of the picture away from its edges.
double greatest_error(const std::vector<float>& rgba, ImageSize size, const Field& field,
                      double margin) {
  const std::vector<float> exact = picture_of(size, field);
  double greatest = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double u = (x + 0.5) / size.width, v = (y + 0.5) / size.height;
      if (std::min({u, v, 1 - u, 1 - v}) < margin) continue;
      const auto i = 4 * static_cast<std::size_t>(y * size.width + x);
      greatest = std::max(greatest, std::abs(double(rgba[i]) - double(exact[i])));
    }
  }
  return greatest;
}

double noise(double x, double y) {
  const double v = std::sin(x * 1298.98 + y * 7823.3) * 43758.5453;
  return v - std::floor(v);
}

TEST(Filters, WeightsOfAllSamplesSumToOneAnywhere) {
  for (const Filter filter : kFilters) {
    for (int i = 0; i < 1000; ++i) {
      const double t = i / 1000.0;
      double sum = 0;
      for (int k = -3; k <= 3; ++k) sum += weight(filter, t - k);
      EXPECT_NEAR(sum, 1, 4e-15) << int(filter) << " " << t;
    }
  }
}

TEST(Filters, KernelsAreEvenAndZeroBeyondTheirSupport) {
  for (const Filter filter : kFilters) {
    const double end = support(filter);
    for (double t = 0.013; t < 3; t += 0.0371) {
      EXPECT_EQ(weight(filter, t), weight(filter, -t));
      if (t > end) {
        EXPECT_EQ(weight(filter, t), 0);
      }
    }
    EXPECT_NE(weight(filter, end - 0.01), 0);
  }
}

TEST(Filters, AllButTheBiquadraticInterpolate) {
  for (const Filter filter : kFilters) {
    for (int k = -3; k <= 3; ++k) {
      const double interpolating = k == 0 ? 1 : 0;
      if (filter != Filter::kBiquadratic) {
        EXPECT_EQ(weight(filter, k), interpolating);
      }
    }
  }
  EXPECT_EQ(weight(Filter::kBiquadratic, 0), 0.75);
  EXPECT_EQ(weight(Filter::kBiquadratic, 1), 0.125);
}

TEST(Filters, AllButTheBoxKeepLinesAndTheBicubicKeepsParabolas) {
  for (const Filter filter : kFilters) {
    for (double t = 0; t < 1; t += 0.05) {
      double first = 0, second = 0;
      for (int k = -3; k <= 3; ++k) {
        first += k * weight(filter, t - k);
        second += k * k * weight(filter, t - k);
      }
      if (filter != Filter::kBox) {
        EXPECT_NEAR(first, t, 1e-14);
      }
      if (filter == Filter::kBicubic) {
        EXPECT_NEAR(second, t * t, 1e-14);
      }
    }
  }
}

TEST(Filters, TheWholePictureAtItsOwnSizeIsTheSameToTheBit) {
  const ImageSize size{37, 23};
  const std::vector<float> picture = picture_of(size, noise);
  for (const Filter filter : kFilters) {
    const std::vector<float> same = resample(picture, size, whole(size), size, filter);
    EXPECT_EQ(same == picture, filter != Filter::kBiquadratic) << int(filter);
  }
}

TEST(Filters, AWindowOnWholePixelsIsAPieceOfThePicture) {
  const ImageSize size{37, 23}, piece{11, 7};
  const std::vector<float> picture = picture_of(size, noise);
  for (const Filter filter : kFilters) {
    if (filter == Filter::kBiquadratic) continue;
    const std::vector<float> cut = resample(picture, size, {9, 5, 11, 7}, piece, filter);
    for (int y = 0; y < piece.height; ++y) {
      const auto row = picture.begin() + 4 * ((y + 5) * size.width + 9);
      EXPECT_TRUE(std::equal(row, row + 4 * piece.width, cut.begin() + 4 * y * piece.width));
    }
  }
}

TEST(Filters, AConstantStaysConstantInAnySizeAndWindow) {
  const ImageSize size{20, 30};
  const Field constant = [](double, double) { return 0.3; };
  const std::vector<float> picture = picture_of(size, constant);
  for (const Filter filter : kFilters) {
    for (const ImageSize to : {ImageSize{1, 1}, {7, 64}, {61, 9}, {20, 30}}) {
      for (const SourceWindow& window : {whole(size), SourceWindow{-4, 3.3, 9, 40}}) {
        const auto result = resample(picture, size, window, to, filter);
        ASSERT_EQ(result.size(), 4u * to.width * to.height);
        EXPECT_LT(greatest_error(result, to, constant, 0), 2e-7);
      }
    }
  }
}

TEST(Filters, ALinearRampIsKeptAwayFromTheEdges) {
  const ImageSize size{40, 40};
  const Field ramp = [](double x, double y) { return 0.1 + 0.4 * x + 0.3 * y; };
  const std::vector<float> picture = picture_of(size, ramp);
  for (const Filter filter : kFilters) {
    for (const ImageSize to : {ImageSize{97, 131}, {20, 10}, {8, 200}}) {
      // The box's steps, magnified, are its error; its means are exact.
      const bool steps = filter == Filter::kBox && to.height > 40;
      const auto result = resample(picture, size, whole(size), to, filter);
      if (!steps) {
        EXPECT_LT(greatest_error(result, to, ramp, 0.2), 1e-6);
      }
    }
  }
}

TEST(Filters, TheErrorFallsWithTheSpacingAtTheFiltersOrder) {
  const Field smooth = [](double x, double y) {
    return 0.5 + 0.2 * std::sin(5 * x) + 0.2 * std::cos(4 * y + 2 * x);
  };
  const ImageSize to{331, 287};
  const std::pair<Filter, double> orders[] = {{Filter::kBox, 1},
                                              {Filter::kBilinear, 2},
                                              {Filter::kBiquadratic, 2},
                                              {Filter::kPiecewiseQuadratic, 2},
                                              {Filter::kBicubic, 3}};
  for (const auto& [filter, order] : orders) {
    double coarse = 0;
    for (const int edge : {20, 40, 80}) {
      const ImageSize from{edge, edge};
      const auto result = resample(picture_of(from, smooth), from, whole(from), to, filter);
      const double error = greatest_error(result, to, smooth, 0.15);
      if (coarse > 0) {
        EXPECT_NEAR(std::log2(coarse / error), order, 0.3) << int(filter);
      }
      RecordProperty("error_" + std::to_string(int(filter)) + "_" + std::to_string(edge),
                     std::to_string(error));
      coarse = error;
    }
  }
}

TEST(Filters, ABoxIsTheMeanOfWhatItCovers) {
  const ImageSize size{30, 20};
  const std::vector<float> picture = picture_of(size, noise);
  const auto thirds = resample(picture, size, whole(size), {10, 5}, Filter::kBox);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 10; ++x) {
      double sum = 0;
      for (int i = 0; i < 12; ++i) {
        sum += double(picture[4 * static_cast<std::size_t>((4 * y + i / 3) * 30 + 3 * x + i % 3)]);
      }
      EXPECT_NEAR(thirds[4 * static_cast<std::size_t>(y * 10 + x)], sum / 12, 1e-6);
    }
  }
}

TEST(Filters, ABoxCountsPixelsThatItCoversInPartByTheirArea) {
  const std::vector<float> picture{1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1};
  const auto halves = resample(picture, {3, 1}, whole({3, 1}), {2, 1}, Filter::kBox);
  EXPECT_FLOAT_EQ(halves[0], 2.0f / 3);
  EXPECT_FLOAT_EQ(halves[1], 1.0f / 3);
  EXPECT_FLOAT_EQ(halves[2], 0);
  EXPECT_FLOAT_EQ(halves[5], 1.0f / 3);
  EXPECT_FLOAT_EQ(halves[6], 2.0f / 3);
}

TEST(Filters, AMirroredPictureIsResampledMirrored) {
  const ImageSize size{15, 12}, to{32, 7};
  std::vector<float> picture = picture_of(size, noise), mirrored(picture.size());
  const auto mirror = [](const std::vector<float>& from, ImageSize of, std::vector<float>& into) {
    for (int i = 0; i < of.width * of.height; ++i) {
      const int other = i / of.width * of.width + of.width - 1 - i % of.width;
      std::copy_n(from.begin() + 4 * i, 4, into.begin() + 4 * other);
    }
  };
  mirror(picture, size, mirrored);
  for (const Filter filter : kFilters) {
    const auto direct = resample(picture, size, whole(size), to, filter);
    std::vector<float> turned(direct.size());
    mirror(resample(mirrored, size, whole(size), to, filter), to, turned);
    for (std::size_t i = 0; i < direct.size(); ++i) EXPECT_NEAR(turned[i], direct[i], 1e-6);
  }
}

TEST(Filters, NothingFallsBelowZeroOrBecomesMoreThanOpaque) {
  const ImageSize size{16, 16}, to{51, 49};
  const Field edge = [](double x, double y) { return x + y > 1.1 ? 1.0 : 0.0; };
  std::vector<float> picture = picture_of(size, edge);
  for (std::size_t i = 3; i < picture.size(); i += 4) picture[i] = picture[i - 3];
  for (const Filter filter : kFilters) {
    const auto result = resample(picture, size, whole(size), to, filter);
    for (std::size_t i = 0; i < result.size(); ++i) {
      EXPECT_GE(result[i], 0);
      if (i % 4 == 3) {
        EXPECT_LE(result[i], 1);
      }
    }
  }
}

}  // namespace
}  // namespace goldthread
