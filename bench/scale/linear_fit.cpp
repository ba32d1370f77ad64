// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/linear_fit.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace goldthread::bench {
namespace {

constexpr int kRounds = 30;

/// Least squares with weights, neither term negative.
LinearFit weighted_fit(std::span<const TimedTerms> measured, std::span<const double> weights) {
  double aa = 0, ab = 0, bb = 0, at = 0, bt = 0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const auto [a, b] = measured[i].x;
    aa += weights[i] * a * a;
    ab += weights[i] * a * b;
    bb += weights[i] * b * b;
    at += weights[i] * a * measured[i].time;
    bt += weights[i] * b * measured[i].time;
  }
  // Of terms in proportion to each other the determinant is roundoff.
  const double determinant = aa * bb - ab * ab;
  if (determinant > 1e-12 * aa * bb) {
    const LinearFit both{(at * bb - bt * ab) / determinant, (bt * aa - at * ab) / determinant, 0};
    if (both.first >= 0 && both.second >= 0) return both;
  }
  const LinearFit first{aa > 0 ? at / aa : 0, 0, 0}, second{0, bb > 0 ? bt / bb : 0, 0};
  const auto gain = [&](const LinearFit& fit) { return fit.first * at + fit.second * bt; };
  return gain(first) >= gain(second) ? first : second;
}

}  // namespace

LinearFit fit_linear(std::span<const TimedTerms> measured) {
  // What residuals are relative to: at first the times, then halfway to each new model, without
  // which two models may follow each other for ever.
  std::vector<double> scale, weights(measured.size());
  for (const TimedTerms& each : measured) scale.push_back(each.time);
  LinearFit fit;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < measured.size(); ++i)
      weights[i] = scale[i] > 0 ? 1 / (scale[i] * scale[i]) : 0;
    fit = weighted_fit(measured, weights);
    for (std::size_t i = 0; i < measured.size(); ++i)
      scale[i] = (scale[i] + fit.at(measured[i].x[0], measured[i].x[1])) / 2;
  }
  for (const TimedTerms& each : measured) {
    const double model = fit.at(each.x[0], each.x[1]);
    if (model > 0) fit.worst = std::max(fit.worst, std::abs(each.time / model - 1));
  }
  return fit;
}

}  // namespace goldthread::bench
