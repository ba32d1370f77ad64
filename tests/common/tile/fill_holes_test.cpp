// SPDX-License-Identifier: Apache-2.0
#include "common/tile/fill_holes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

namespace goldthread {
namespace {

constexpr Filter kFilters[] = {Filter::kBox, Filter::kBilinear, Filter::kBiquadratic,
                               Filter::kPiecewiseQuadratic, Filter::kBicubic};
/// A number of one position, for red; the other channels follow from it.
using Field = std::function<double(double x, double y)>;

Sample sample_of(double value) {
  const auto v = static_cast<float>(value);
  return {v, v / 2, 1 - v, v};
}

/// A tile of places; unknown ones hold `junk` until they are filled.
struct Tile {
  int stride, rows;
  std::vector<Sample> samples;
  std::vector<std::uint8_t> known;
  static constexpr Sample kJunk{77, 77, 77, 77};

  Tile(int columns, int lines)
      : stride(columns),
        rows(lines),
        samples(static_cast<std::size_t>(columns * lines), kJunk),
        known(samples.size(), 0) {}
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y * stride + x); }
  void set(int x, int y, const Field& field) {
    samples[index(x, y)] = sample_of(field(x, y));
    known[index(x, y)] = 1;
  }
  const Sample& at(int x, int y) const { return samples[index(x, y)]; }
  void fill(Filter filter) { fill_holes({stride, rows, samples, known}, filter); }
};

Tile sampled(int stride, int rows, int spacing, const Field& field) {
  Tile tile(stride, rows);
  for (int y = 0; y < rows; y += spacing) {
    for (int x = 0; x < stride; x += spacing) tile.set(x, y, field);
  }
  return tile;
}

/// Every 16th place, and each other with a probability.
Tile sparse(int stride, int rows, double share, unsigned seed, const Field& field) {
  Tile tile = sampled(stride, rows, 16, field);
  std::mt19937 random(seed);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < stride; ++x) {
      if (std::generate_canonical<double, 32>(random) < share) tile.set(x, y, field);
    }
  }
  return tile;
}

/// The greatest error of red at places at least `margin` away from the tile's edges.
double greatest_error(const Tile& tile, const Field& field, int margin = 0) {
  double greatest = 0;
  for (int y = margin; y < tile.rows - margin; ++y) {
    for (int x = margin; x < tile.stride - margin; ++x) {
      greatest = std::max(greatest, std::abs(double(tile.at(x, y).red) - field(x, y)));
    }
  }
  return greatest;
}

double rms_error(const Tile& tile, const Field& field, int margin) {
  double sum = 0;
  int count = 0;
  for (int y = margin; y < tile.rows - margin; ++y) {
    for (int x = margin; x < tile.stride - margin; ++x, ++count) {
      sum += std::pow(double(tile.at(x, y).red) - field(x, y), 2);
    }
  }
  return std::sqrt(sum / count);
}

double noise(double x, double y) {
  const double v = std::sin(x * 12.9898 + y * 78.233) * 43758.5453;
  return v - std::floor(v);
}
double ramp(double x, double y) { return 0.2 + 0.003 * x + 0.005 * y; }

TEST(FillHoles, KnownPlacesAreNeverChanged) {
  for (const Filter filter : kFilters) {
    const Tile before = sparse(65, 33, 0.3, 1, noise);
    Tile after = before;
    after.fill(filter);
    for (std::size_t i = 0; i < before.samples.size(); ++i) {
      if (before.known[i]) {
        EXPECT_EQ(after.samples[i], before.samples[i]);
      }
    }
  }
}

TEST(FillHoles, ATileThatHoldsNothingIsLeftAsItIs) {
  for (const Filter filter : kFilters) {
    Tile tile(65, 65);
    tile.fill(filter);
    for (const Sample& sample : tile.samples) EXPECT_EQ(sample, Tile::kJunk);
  }
}

TEST(FillHoles, AConstantStaysConstantToTheBit) {
  const Field constant = [](double, double) { return 0.3; };
  for (const Filter filter : kFilters) {
    for (const double share : {0.0, 0.1, 0.9}) {
      Tile tile = sparse(33, 65, share, 2, constant);
      tile.fill(filter);
      for (const Sample& sample : tile.samples) {
        EXPECT_NEAR(sample.red, sample_of(0.3).red, filter == Filter::kBicubic ? 1e-7 : 0);
      }
    }
  }
}

TEST(FillHoles, OneOtherSampleInAConstantTileIsSeen) {
  const Field constant = [](double, double) { return 0.3; };
  for (int y = 0; y < 17; ++y) {
    for (int x = 0; x < 33; ++x) {
      Tile tile = sampled(33, 17, 16, constant);
      tile.set(x, y, [](double, double) { return 0.7; });
      tile.fill(Filter::kBilinear);
      ASSERT_EQ(tile.at(x, y), sample_of(0.7)) << x << " " << y;
      ASSERT_NE(tile.at(x > 0 ? x - 1 : x + 1, y), Tile::kJunk) << x << " " << y;
    }
  }
}

TEST(FillHoles, AllFiltersButTheBoxKeepALinearRampWhateverIsKnown) {
  for (const Filter filter : kFilters) {
    if (filter == Filter::kBox) continue;
    for (const double share : {0.0, 0.05, 0.5}) {
      Tile tile = sparse(65, 49, share, 3, ramp);
      tile.fill(filter);
      EXPECT_LT(greatest_error(tile, ramp), 3e-7) << int(filter) << " " << share;
    }
  }
}

TEST(FillHoles, BicubicKeepsCubicsInsideAndParabolasUpToTheEdge) {
  const auto t = [](double x) { return x / 64 - 0.4; };
  const Field cubic = [&](double x, double y) {
    return 0.5 + 0.2 * (t(x) * t(x) * t(x) - t(y) * t(y) * t(y) + t(x) * t(y));
  };
  const Field parabola = [&](double x, double y) { return 0.1 + t(x) * t(x) + t(y) * t(y) / 2; };
  Tile inside = sampled(97, 97, 8, cubic), whole = sampled(97, 97, 16, parabola);
  inside.fill(Filter::kBicubic);
  whole.fill(Filter::kBicubic);
  EXPECT_LT(greatest_error(inside, cubic, 16), 1e-6);
  EXPECT_GT(greatest_error(inside, cubic), 1e-5) << "three points do not make a cubic";
  EXPECT_LT(greatest_error(whole, parabola), 1e-6);
}

TEST(FillHoles, TheErrorFallsWithTheSpacingAtTheFiltersOrder) {
  const Field smooth = [](double x, double y) {
    return 0.5 + 0.25 * std::sin(x / 24) + 0.2 * std::cos(y / 30 + x / 40);
  };
  for (const auto& [filter, order] :
       {std::pair{Filter::kBox, 1.0}, {Filter::kBilinear, 2.0}, {Filter::kBicubic, 4.0}}) {
    double coarse = 0;
    for (const int spacing : {16, 8, 4}) {
      Tile tile = sampled(129, 129, spacing, smooth);
      tile.fill(filter);
      const double error = rms_error(tile, smooth, 48);
      if (coarse > 0) {
        EXPECT_NEAR(std::log2(coarse / error), order, 0.25) << spacing;
      }
      RecordProperty("error_" + std::to_string(int(filter)) + "_" + std::to_string(spacing),
                     std::to_string(error));
      coarse = error;
    }
  }
}

TEST(FillHoles, BoxAndBilinearNeverLeaveTheRangeOfWhatIsKnown) {
  for (const Filter filter : kFilters) {
    if (filter == Filter::kBicubic) continue;
    for (unsigned seed = 0; seed < 20; ++seed) {
      Tile tile = sparse(65, 65, seed * 0.02, seed, noise);
      float low = 1, high = 0;
      for (std::size_t i = 0; i < tile.samples.size(); ++i) {
        if (!tile.known[i]) continue;
        low = std::min(low, tile.samples[i].red);
        high = std::max(high, tile.samples[i].red);
      }
      tile.fill(filter);
      for (const Sample& sample : tile.samples) {
        EXPECT_GE(sample.red, low);
        EXPECT_LE(sample.red, high);
      }
    }
  }
}

TEST(FillHoles, BicubicOvershootsNeitherBelowZeroNorBeyondOpaque) {
  const Field edge = [](double x, double y) { return x + y > 40 ? 1.0 : 0.0; };
  Tile tile = sampled(65, 65, 16, edge);
  tile.fill(Filter::kBicubic);
  float brightest = 0;
  for (const Sample& sample : tile.samples) {
    EXPECT_GE(std::min({sample.red, sample.green, sample.blue, sample.alpha}), 0);
    EXPECT_LE(sample.alpha, 1);
    brightest = std::max(brightest, sample.red);
  }
  EXPECT_GT(brightest, 1) << "the edge does overshoot";
}

TEST(FillHoles, BoxShowsConstantSquares) {
  Tile tile = sampled(65, 33, 4, noise);
  tile.fill(Filter::kBox);
  for (int y = 0; y < tile.rows; ++y) {
    for (int x = 0; x < tile.stride; ++x) EXPECT_EQ(tile.at(x, y), tile.at(x & ~3, y & ~3));
  }
}

TEST(FillHoles, AMirroredTileIsFilledMirrored) {
  for (const Filter filter : {Filter::kBilinear, Filter::kBicubic}) {
    Tile tile = sparse(49, 49, 0.1, 7, noise), flipped = tile, turned = tile;
    for (int y = 0; y < 49; ++y) {
      for (int x = 0; x < 49; ++x) {
        flipped.samples[tile.index(48 - x, y)] = tile.at(x, y);
        flipped.known[tile.index(48 - x, y)] = tile.known[tile.index(x, y)];
        turned.samples[tile.index(y, x)] = tile.at(x, y);
        turned.known[tile.index(y, x)] = tile.known[tile.index(x, y)];
      }
    }
    for (Tile* each : {&tile, &flipped, &turned}) each->fill(filter);
    for (int y = 0; y < 49; ++y) {
      for (int x = 0; x < 49; ++x) {
        EXPECT_FLOAT_EQ(flipped.at(48 - x, y).red, tile.at(x, y).red);
        EXPECT_FLOAT_EQ(turned.at(y, x).red, tile.at(x, y).red);
      }
    }
  }
}

TEST(FillHoles, FillingAgainAfterMoreIsKnownIsAsFillingOnce) {
  for (const Filter filter : kFilters) {
    Tile twice = sparse(65, 65, 0.05, 8, noise);
    twice.fill(filter);
    Tile once = sparse(65, 65, 0.3, 9, noise);
    for (std::size_t i = 0; i < once.samples.size(); ++i) {
      if (once.known[i]) twice.samples[i] = once.samples[i];
    }
    twice.known = once.known;
    twice.fill(filter);
    once.fill(filter);
    EXPECT_EQ(twice.samples, once.samples);
  }
}

}  // namespace
}  // namespace goldthread
