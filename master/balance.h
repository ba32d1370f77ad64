// SPDX-License-Identifier: Apache-2.0
#pragma once
// How even the work was, and how well it was foreseen. Pure.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>

namespace goldthread {

/// The busiest worker's time over the mean, less 1: 0 if all have worked alike, or not at all.
inline double imbalance(std::span<const double> busy) {
  const double sum = std::accumulate(busy.begin(), busy.end(), 0.0);
  if (!(sum > 0)) return 0;
  return *std::max_element(busy.begin(), busy.end()) * double(busy.size()) / sum - 1;
}

/// Σ|predicted − actual| / Σ actual, of as many tiles; 0 of nothing.
inline double prediction_error(std::span<const double> predicted, std::span<const double> actual) {
  double off = 0, sum = 0;
  for (std::size_t i = 0; i < actual.size(); ++i) {
    off += std::abs(predicted[i] - actual[i]);
    sum += actual[i];
  }
  return sum > 0 ? off / sum : 0;
}

}  // namespace goldthread
