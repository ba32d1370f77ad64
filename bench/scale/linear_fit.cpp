// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/linear_fit.h"

#include <algorithm>
#include <cmath>

namespace goldthread::bench {
namespace {

/// With the terms divided by the time: the sums of the normal equations for the target 1.
struct Sums {
  double aa = 0, ab = 0, bb = 0, a = 0, b = 0;
};

double squares(const Sums& s, double first, double second) {
  return first * first * s.aa + 2 * first * second * s.ab + second * second * s.bb -
         2 * (first * s.a + second * s.b);
}

}  // namespace

LinearFit fit_linear(std::span<const TimedTerms> measured) {
  Sums s;
  for (const TimedTerms& each : measured) {
    if (!(each.time > 0)) continue;
    const double a = each.x[0] / each.time, b = each.x[1] / each.time;
    s.aa += a * a;
    s.ab += a * b;
    s.bb += b * b;
    s.a += a;
    s.b += b;
  }
  const double first_alone = s.aa > 0 ? s.a / s.aa : 0, second_alone = s.bb > 0 ? s.b / s.bb : 0;
  LinearFit fit;
  // Of terms in proportion to each other the determinant is roundoff.
  const double determinant = s.aa * s.bb - s.ab * s.ab;
  if (determinant > 1e-12 * s.aa * s.bb) {
    fit.first = (s.a * s.bb - s.b * s.ab) / determinant;
    fit.second = (s.b * s.aa - s.a * s.ab) / determinant;
  }
  if (determinant <= 1e-12 * s.aa * s.bb || fit.first < 0 || fit.second < 0) {
    const bool first = squares(s, first_alone, 0) <= squares(s, 0, second_alone);
    fit = {first ? first_alone : 0, first ? 0 : second_alone, 0};
  }
  for (const TimedTerms& each : measured)
    if (each.time > 0)
      fit.worst = std::max(fit.worst, std::abs(fit.at(each.x[0], each.x[1]) / each.time - 1));
  return fit;
}

}  // namespace goldthread::bench
