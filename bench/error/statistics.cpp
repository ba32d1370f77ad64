// SPDX-License-Identifier: Apache-2.0
#include "bench/error/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/image/color.h"

namespace goldthread::bench {
namespace {

constexpr double kLevels = 255;

/// The largest difference of a channel, in 1/255.
double largest_difference(const Color& a, const Color& b, double& square_sum) {
  double largest = 0;
  for (int c = 0; c < 3; ++c) {
    const double off = kLevels * std::abs(a[c] - b[c]);
    const double counted = std::isfinite(off) ? off : kLevels;
    square_sum += counted * counted;
    largest = std::max(largest, counted);
  }
  return largest;
}

}  // namespace

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto rank = static_cast<std::size_t>(std::ceil(share * double(values.size())));
  const auto at = values.begin() + std::ptrdiff_t(std::max(rank, std::size_t{1}) - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

Seconds summarize(std::span<const double> seconds) {
  if (seconds.empty()) return {};
  return {*std::min_element(seconds.begin(), seconds.end()),
          median({seconds.begin(), seconds.end()}), static_cast<int>(seconds.size())};
}

PictureError picture_error(std::span<const Color> shown, std::span<const Color> reference) {
  constexpr double kOff = 32;
  const std::size_t count = std::min(shown.size(), reference.size());
  if (count == 0) return {};
  double square_sum = 0;
  std::vector<double> differences(count);
  for (std::size_t i = 0; i < count; ++i)
    differences[i] = largest_difference(shown[i], reference[i], square_sum);
  const auto off = std::count_if(differences.begin(), differences.end(),
                                 [](double difference) { return difference > kOff; });
  return {std::sqrt(square_sum / (3 * double(count))), percentile(differences, 0.999),
          *std::max_element(differences.begin(), differences.end()), double(off) / double(count)};
}

Color displayed(const glm::dvec3& premultiplied, double alpha, const glm::dvec3& background,
                bool linear) {
  Color color = premultiplied;
  for (int c = 0; c < 3; ++c) {
    const double behind = linear ? linear_from_srgb(background[c]) : background[c];
    color[c] += (1 - alpha) * behind;
    if (linear) color[c] = srgb_from_linear(color[c]);
    color[c] = std::clamp(color[c], 0.0, 1.0);
  }
  return color;
}

Color displayed(const Sample& sample, const glm::dvec3& background, bool linear) {
  return displayed(glm::dvec3(sample.red, sample.green, sample.blue), sample.alpha, background,
                   linear);
}

std::vector<Shift> candidate_shifts() {
  std::vector<Shift> shifts;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) shifts.push_back({0.5 * x, 0.5 * y});
  std::stable_sort(shifts.begin(), shifts.end(), [](const Shift& a, const Shift& b) {
    return std::hypot(a.x, a.y) < std::hypot(b.x, b.y);
  });
  return shifts;
}

Alignment best_alignment(std::span<const Color> shown,
                         const std::function<std::vector<Color>(Shift)>& reference_at) {
  Alignment best;
  best.error.rms = std::numeric_limits<double>::infinity();
  for (const Shift shift : candidate_shifts()) {
    const PictureError error = picture_error(shown, reference_at(shift));
    if (error.rms < best.error.rms) best = {shift, error};
  }
  return best;
}

double order_between(double coarse_step, double coarse_error, double fine_step, double fine_error) {
  return std::log(coarse_error / fine_error) / std::log(coarse_step / fine_step);
}

}  // namespace goldthread::bench
