// SPDX-License-Identifier: Apache-2.0
#include "worker/refinement/pixel_sums.h"

#include <algorithm>
#include <cmath>

namespace goldthread {
namespace {

/// Where centres are off by this share of their bends, or more, the bends are edges.
constexpr double kEdgeShare = 0.14;
/// The error of Sobol samples at edges: variance / count^3/2, times this.
constexpr double kEdgeGain = 0.47;
/// Of an edge of height 1 that no sample of `count` has met: p = ½/(count + 1) is the likely share
/// of the pixel behind it, p its variance.
constexpr double kUnmet = 0.5 / (kEdgeShare * kEdgeShare);

/// What is smooth converges faster, the more so the smoother it is; what is thinner than a pixel
/// slower.
double gain_of(double squared_share) {
  return kEdgeGain * std::min(2.0, std::pow(squared_share / (kEdgeShare * kEdgeShare), 0.75));
}

}  // namespace

PixelErrorModel::PixelErrorModel(double squared_share)
    : gain(gain_of(squared_share)), unmet(kUnmet * squared_share) {}

PixelSum::PixelSum(SampleOffset place, double bend, const Sample& first, const Shown& first_shown)
    : place_(place), bend_(bend), centre_(first_shown) {
  add(first, first_shown);
}

void PixelSum::add(const Sample& sample, const Shown& shown) {
  ++count_;
  sums_[0] += double(sample.red);
  sums_[1] += double(sample.green);
  sums_[2] += double(sample.blue);
  sums_[3] += double(sample.alpha);
  for (std::size_t c = 0; c < 3; ++c) {
    const double value = double(shown.value[c]);
    const double before = value - means_[c];
    means_[c] += before / count_;
    squares_ += before * (value - means_[c]);
  }
}

Sample PixelSum::mean() const {
  const double share = 1.0 / count_;
  return {static_cast<float>(sums_[0] * share), static_cast<float>(sums_[1] * share),
          static_cast<float>(sums_[2] * share), static_cast<float>(sums_[3] * share)};
}

double PixelSum::squared_error(const PixelErrorModel& model) const {
  const double count = count_;
  const double unmet = model.unmet * bend_ * bend_ / (count + 1);
  return model.gain * (variance() + unmet) / (count * std::sqrt(count));
}

Shown PixelSum::mean_of_others() const {
  Shown others = centre_;
  if (count_ < 2) return others;
  for (std::size_t c = 0; c < 3; ++c) {
    const double sum = means_[c] * count_ - double(centre_.value[c]);
    others.value[c] = static_cast<float>(sum / (count_ - 1));
  }
  return others;
}

}  // namespace goldthread
