// SPDX-License-Identifier: Apache-2.0
// Tiles leave no mark in the picture: at their borders it is as good as anywhere else, and other
// tiles do not make another picture.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>

#include "refinement_support.h"

namespace goldthread::test {
namespace {

constexpr int kEdge = 256;
constexpr ImageSize kImage{kEdge, kEdge};
constexpr int kPictures = 32;
/// Of Student's distribution with 31 degrees of freedom, for a confidence of 99%, two-sided.
constexpr double kStudent = 2.744;

/// Waves with a circle and a straight edge in them, nowhere in particular.
PictureFunction random_picture(Dice& dice) {
  const double fx = dice.between(0.02, 0.15), fy = dice.between(0.02, 0.15);
  const double phase = dice.between(0, 6), angle = dice.between(0, 2 * M_PI);
  const double cx = dice.between(0, kEdge), cy = dice.between(0, kEdge),
               radius = dice.between(20, 90);
  const double nx = std::cos(angle), ny = std::sin(angle);
  const double off = nx * dice.between(0, kEdge) + ny * dice.between(0, kEdge);
  return [=](PixelPosition p) {
    const double x = double(p.x), y = double(p.y);
    double value = 0.4 + 0.2 * std::sin(fx * x + phase) * std::cos(fy * y);
    if (std::hypot(x - cx, y - cy) < radius) value += 0.25;
    if (nx * x + ny * y > off) value -= 0.15;
    return grey(value);
  };
}

/// Several numbers, one for each picture.
struct Paired {
  double mean = 0;
  double half_width = 0;  ///< of the confidence interval

  explicit Paired(const std::vector<double>& values) {
    const auto count = double(values.size());
    for (const double value : values) mean += value / count;
    double squares = 0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    half_width = kStudent * std::sqrt(squares / (count - 1) / count);
  }
};

/// Mean squared error of the rows and columns for which is_counted(their number).
template <class IsCounted>
double squared_error_of_lines(const std::vector<Sample>& pixels, const std::vector<Sample>& truth,
                              const IsCounted& is_counted) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < kEdge; ++y)
    for (int x = 0; x < kEdge; ++x)
      for (const int line : {x, y}) {
        if (!is_counted(line)) continue;
        const auto i = std::size_t(y * kEdge + x);
        sum += squared_difference(pixels[i], truth[i]);
        ++count;
      }
  return sum / count;
}

bool at_border(int line) {
  return line >= 63 && line < kEdge - 1 && (line % 64 == 0 || line % 64 == 63);
}
/// Lines inside of tiles that lie in the grid of coarse samples as those at borders do.
bool alike_inside(int line) {
  return (line % 16 == 0 || line % 16 == 15) && line % 64 != 0 && line % 64 != 63;
}

/// What all pictures say of one step, as logarithms of ratios.
struct Found {
  std::vector<double> border_to_inside;  ///< of squared errors
  std::vector<double> small_to_large;    ///< of the errors by tiles of 64 and of 128
};

const std::map<Step, Found>& found() {
  static const std::map<Step, Found> all = [] {
    std::map<Step, Found> by_step;
    Dice dice(1);
    for (int i = 0; i < kPictures; ++i) {
      const auto cast = cast_of(random_picture(dice));
      const auto truth = true_pixels(kImage, cast);
      RefinedPicture small(TileGrid::squares(kImage, 64), cast);
      RefinedPicture large(TileGrid::squares(kImage, 128), cast);
      for (const Step step : {Step{4}, Step{5}, Step{7}}) {
        small.advance_to(step);
        large.advance_to(step);
        const auto pixels = small.pixels();
        by_step[step].border_to_inside.push_back(
            std::log(squared_error_of_lines(pixels, truth, at_border) /
                     squared_error_of_lines(pixels, truth, alike_inside)));
        by_step[step].small_to_large.push_back(
            std::log(rms_difference(pixels, truth) / rms_difference(large.pixels(), truth)));
      }
    }
    return by_step;
  }();
  return all;
}

void print(const char* what, Step step, const Paired& log_ratio) {
  std::printf("  step %d: %s: %.3f, at 99%% confidence %.3f … %.3f\n", step.value, what,
              std::exp(log_ratio.mean), std::exp(log_ratio.mean - log_ratio.half_width),
              std::exp(log_ratio.mean + log_ratio.half_width));
}

TEST(Seams, TheErrorAtTilesBordersIsThatOfOtherLines) {
  for (const auto& [step, ratios] : found()) {
    const Paired log_ratio(ratios.border_to_inside);
    print("squared error at borders / inside", step, log_ratio);
    EXPECT_LE(std::abs(log_ratio.mean), log_ratio.half_width);
    EXPECT_LE(log_ratio.half_width, 0.5) << "or nothing could be seen";
  }
}

TEST(Seams, LargerTilesMakeAPictureAsGood) {
  for (const auto& [step, ratios] : found()) {
    const Paired log_ratio(ratios.small_to_large);
    print("error by tiles of 64 / of 128", step, log_ratio);
    EXPECT_LE(std::abs(log_ratio.mean) + log_ratio.half_width, 0.1);
  }
}

}  // namespace
}  // namespace goldthread::test
