// SPDX-License-Identifier: Apache-2.0
#pragma once
// Measured times as sums of two terms. Pure.

#include <array>
#include <span>

namespace goldthread::bench {

/// time ≈ first · x[0] + second · x[1], neither negative.
struct LinearFit {
  double first = 0;
  double second = 0;
  double worst = 0;  ///< the largest |measured / model − 1|
  double at(double x0, double x1) const { return first * x0 + second * x1; }
};

struct TimedTerms {
  std::array<double, 2> x{};
  double time = 0;
};

/// Least squares of residuals relative to the model (iteratively reweighted), so that small times
/// count as much as large ones and neither pulls harder.
LinearFit fit_linear(std::span<const TimedTerms> measured);

}  // namespace goldthread::bench
