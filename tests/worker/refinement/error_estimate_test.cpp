// SPDX-License-Identifier: Apache-2.0
// Whether the error that a picture is said to have is the one it has: rays decide when to stop by
// it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "bench/error/subject.h"
#include "refinement_support.h"
#include "worker/ray_caster.h"

namespace goldthread::test {
namespace {

constexpr ImageSize kImage{256, 256};
/// True errors, in 1/255, for which the estimate is held to account.
constexpr double kMostError = 10, kLeastError = 0.2;
constexpr double kLeastRatio = 0.7, kMostRatio = 1.5;

/// Refines until the true error is below kLeastError; the estimate must be near it all the way.
void expect_calibrated(const char* name, const TileRefinement::Cast& cast,
                       bool with_surfaces = false) {
  const auto truth = true_pixels(kImage, cast);
  RefinedPicture picture(TileGrid::squares(kImage, 64), cast, {}, with_surfaces);
  picture.advance_to({2});
  double error = kMostError;
  std::printf("  %-12s step  true  estimated  ratio\n", name);
  int counted = 0;
  while (error >= kLeastError && picture.step() < Step{20}) {
    picture.advance();
    error = rms_difference(picture.pixels(), truth);
    const double estimate =
        255 * std::sqrt(picture.estimated_squared_error() / (kImage.width * kImage.height));
    std::printf("  %-12s %4d %6.3f %9.3f %7.2f\n", "", picture.step().value, error, estimate,
                estimate / error);
    if (error > kMostError || error < kLeastError) continue;
    ++counted;
    EXPECT_GE(estimate, kLeastRatio * error) << name << ", step " << picture.step().value;
    EXPECT_LE(estimate, kMostRatio * error) << name << ", step " << picture.step().value;
  }
  EXPECT_GE(counted, 1) << name;
}

class HeadEstimate : public testing::TestWithParam<bench::Look> {};
INSTANTIATE_TEST_SUITE_P(ErrorEstimate, HeadEstimate, testing::ValuesIn(bench::kLooks),
                         [](const auto& tested) { return std::string(name_of(tested.param)); });

TEST_P(HeadEstimate, IsCalibrated) {
  auto subject = bench::load_subject(bench::default_scene(), true);
  if (!subject) GTEST_SKIP() << "Debian's mricron-data is not installed";
  Scene scene = subject->in(GetParam());
  scene.image.size = kImage;
  const auto committed = commit_scene(scene, subject->volume);
  const auto source = make_ray_caster(committed, *scene.camera, kImage);
  expect_calibrated(
      name_of(GetParam()),
      [&](auto positions, auto samples, auto surfaces) {
        source->cast(positions, samples, surfaces);
        return true;
      },
      source->has_surfaces());
}

TEST(ErrorEstimate, OfACheckerboardIsCalibrated) {
  const double cosine = std::cos(0.3), sine = std::sin(0.3);
  expect_calibrated("checkerboard", cast_of([=](PixelPosition p) {
                      const double u = cosine * double(p.x) + sine * double(p.y) + 512;
                      const double v = cosine * double(p.y) - sine * double(p.x) + 512;
                      return grey((int(u / 37) + int(v / 37)) % 2 == 0 ? 0.2 : 0.8);
                    }));
}

TEST(ErrorEstimate, OfSmoothGaussiansIsCalibrated) {
  expect_calibrated("Gaussians", cast_of([](PixelPosition p) {
                      Dice dice(4);
                      double value = 0;
                      for (int i = 0; i < 24; ++i) {
                        const double x = dice.between(0, 256), y = dice.between(0, 256),
                                     width = dice.between(6, 24);
                        const double height = dice.between(0.1, 0.35);
                        const double r = std::hypot(double(p.x) - x, double(p.y) - y) / width;
                        value += height * std::exp(-0.5 * r * r);
                      }
                      return grey(std::min(value, 1.0));
                    }));
}

/// Smooth between the corners of cells of two pixels, where it is by chance.
TEST(ErrorEstimate, OfNoiseIsCalibrated) {
  expect_calibrated("noise", cast_of([](PixelPosition p) {
                      const auto at = [](int i, int j) {
                        return Dice(std::uint64_t(i) * 65537 + std::uint64_t(j)).between(0.3, 0.7);
                      };
                      const double u = double(p.x) / 3, v = double(p.y) / 3;
                      const int i = int(u), j = int(v);
                      const double x = u - i, y = v - j;
                      return grey((at(i, j) * (1 - x) + at(i + 1, j) * x) * (1 - y) +
                                  (at(i, j + 1) * (1 - x) + at(i + 1, j + 1) * x) * y);
                    }));
}

TEST(ErrorEstimate, OfThinLinesIsCalibrated) {
  expect_calibrated("thin lines", cast_of([](PixelPosition p) {
                      Dice dice(7);
                      for (int i = 0; i < 12; ++i) {
                        const double angle = dice.between(0, M_PI);
                        const double x = dice.between(0, 256), y = dice.between(0, 256);
                        const double across = (double(p.y) - y) * std::cos(angle) -
                                              (double(p.x) - x) * std::sin(angle);
                        if (std::abs(across) < 0.6) return grey(0.6);
                      }
                      return grey(0.3);
                    }));
}

}  // namespace
}  // namespace goldthread::test
