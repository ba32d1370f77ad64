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
  double worst = 0;  ///< the largest |model / measured − 1|
  double at(double x0, double x1) const { return first * x0 + second * x1; }
};

struct TimedTerms {
  std::array<double, 2> x{};
  double time = 0;  ///< > 0; others are left out
};

/// Least squares of the relative residuals, so that small times count as much as large ones.
LinearFit fit_linear(std::span<const TimedTerms> measured);

}  // namespace goldthread::bench
