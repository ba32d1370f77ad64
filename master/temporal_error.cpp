// SPDX-License-Identifier: Apache-2.0
#include "master/temporal_error.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace goldthread {
namespace {

/// Nothing if neither camera sees the point.
std::optional<double> movement(const std::optional<glm::dvec2>& from,
                               const std::optional<glm::dvec2>& to, double most) {
  if (!from && !to) return {};
  if (!from || !to) return most;
  const double distance = glm::length(*to - *from);
  // Not std::min: far beside a camera the difference of two infinities is not a number.
  return distance < most ? distance : most;
}

}  // namespace

double temporal_error_px(std::span<const glm::dvec3> points_mm, const Camera& shown,
                         const Camera& newest, ImageSize size) {
  if (shown == newest) return 0;
  const Projection before(shown, size), now(newest, size);
  double sum = 0;
  std::size_t count = 0;
  for (const glm::dvec3& point : points_mm) {
    if (const auto moved = movement(before.at(point), now.at(point), size.height)) {
      sum += *moved * *moved;
      ++count;
    }
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0;
}

double spatial_error_px(double squared_error, double squared_gradient) {
  if (!(squared_error > 0)) return 0;
  if (!(squared_gradient > 0)) return kLargestSpatialErrorPx;
  return std::min(std::sqrt(squared_error / squared_gradient), kLargestSpatialErrorPx);
}

}  // namespace goldthread
