// SPDX-License-Identifier: Apache-2.0
#include "refinement.h"

#include <cmath>
#include <cstdio>

namespace goldthread::test {

double Study::order() const {
  double x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const double u = std::log(sizes[i]), v = std::log(errors[i]);
    x += u, y += v, xx += u * u, xy += u * v;
  }
  const auto count = double(sizes.size());
  return (count * xy - x * y) / (count * xx - x * x);
}

Study study(const std::string& name, const std::vector<double>& sizes,
            const std::function<double(double size)>& error_at) {
  Study result;
  std::printf("  %s\n", name.c_str());
  for (const double size : sizes) {
    result.sizes.push_back(size);
    result.errors.push_back(error_at(size));
    std::printf("    size %-10.5g error %.3e\n", size, result.errors.back());
  }
  std::printf("    order %.3f\n", result.order());
  return result;
}

std::vector<double> falling_sizes(double first, int count) {
  std::vector<double> sizes;
  for (int i = 0; i < count; ++i) sizes.push_back(first * std::pow(0.5, 0.5 * i));
  return sizes;
}

}  // namespace goldthread::test
