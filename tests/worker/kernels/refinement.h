// SPDX-License-Identifier: Apache-2.0
#pragma once
// Refinement studies (Etiene et al. 2014): errors at several resolutions, and the order with which
// they fall, fitted by least squares in log-log.

#include <functional>
#include <string>
#include <vector>

namespace goldthread::test {

struct Study {
  std::vector<double> sizes;   ///< of a step or a voxel
  std::vector<double> errors;  ///< greater than 0
  /// The exponent p of error = C·sizeᵖ.
  double order() const;
};

/// `error_at` at each of at least four sizes; printed under `name` with the order.
Study study(const std::string& name, const std::vector<double>& sizes,
            const std::function<double(double size)>& error_at);

/// `count` sizes from `first` down, each by 1/√2.
std::vector<double> falling_sizes(double first, int count);

}  // namespace goldthread::test
