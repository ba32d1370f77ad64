// SPDX-License-Identifier: Apache-2.0
#include "master/cost_image.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/scene/camera.h"

namespace goldthread {
namespace {

constexpr int kBlock = kCoarsestSpacing;
constexpr double kUnknown = -1;

int blocks_along(int pixels) { return (pixels + kBlock - 1) / kBlock; }

/// Along the camera's view, of the points in front of it.
std::optional<double> median_depth(const Camera& camera, const CameraBasis& basis,
                                   std::span<const glm::dvec3> points_mm) {
  std::vector<double> depths;
  for (const glm::dvec3& point : points_mm) {
    const double depth = glm::dot(point - camera.position, basis.forward);
    if (depth > 0) depths.push_back(depth);
  }
  if (depths.empty()) return {};
  const auto middle = depths.begin() + std::ptrdiff_t(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

/// The two blocks beside a place along an axis, in pixels, and the second one's weight.
struct Between {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  double weight = 0;
};
Between between(double pixels, int blocks) {
  const double at = std::clamp(pixels / kBlock - 0.5, 0.0, double(blocks - 1));
  const auto first = static_cast<std::uint32_t>(at);
  return {first, std::min(first + 1, static_cast<std::uint32_t>(blocks - 1)), at - first};
}

Warp::Tap tap_at(const glm::dvec2& place, int columns, int rows) {
  const Between x = between(place.x, columns), y = between(place.y, rows);
  const auto width = static_cast<std::uint32_t>(columns);
  return {{y.first * width + x.first, y.first * width + x.second, y.second * width + x.first,
           y.second * width + x.second},
          {(1 - y.weight) * (1 - x.weight), (1 - y.weight) * x.weight, y.weight * (1 - x.weight),
           y.weight * x.weight}};
}

}  // namespace

Warp warp_of(ImageSize image, const Camera& older, const Camera& newer,
             std::span<const glm::dvec3> points_mm) {
  const CameraBasis basis = camera_basis(newer);
  const auto depth = median_depth(newer, basis, points_mm);
  if (!depth) return {};
  const Projection before(older, image);
  const int columns = blocks_along(image.width), rows = blocks_along(image.height);
  Warp warp;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Ray ray = camera_ray(newer, image, (column + 0.5) * kBlock, (row + 0.5) * kBlock);
      const double distance = *depth / glm::dot(ray.direction, basis.forward);
      const auto place = before.at(ray.origin + distance * ray.direction);
      warp.taps.push_back(place ? tap_at(*place, columns, rows) : Warp::Tap{});
    }
  }
  return warp;
}

CostImage::CostImage(ImageSize image)
    : image_(image),
      columns_(blocks_along(image.width)),
      us_per_pixel_(std::size_t(columns_) * std::size_t(blocks_along(image.height)), kUnknown) {}

double CostImage::area(int column, int row) const {
  return double(std::min(kBlock, image_.width - column * kBlock)) *
         std::min(kBlock, image_.height - row * kBlock);
}

template <class F>
void CostImage::each_block(const PixelRect& rect, F f) const {
  for (int row = rect.y / kBlock; row * kBlock < rect.y + rect.height; ++row)
    for (int column = rect.x / kBlock; column * kBlock < rect.x + rect.width; ++column)
      f(std::size_t(row) * std::size_t(columns_) + std::size_t(column), area(column, row));
}

void CostImage::set(std::size_t block, double area, double us_per_pixel) {
  double& entry = us_per_pixel_[block];
  if (entry >= 0) {
    known_pixels_ -= area;
    known_us_ -= area * entry;
  }
  entry = us_per_pixel;
  known_pixels_ += area;
  known_us_ += area * entry;
}

void CostImage::record(const PixelRect& rect, double us) {
  const double us_per_pixel = us / (double(rect.width) * rect.height);
  each_block(rect, [&](std::size_t block, double area) { set(block, area, us_per_pixel); });
}

double CostImage::predict_us(const PixelRect& rect) const {
  if (empty()) return 0;
  const double mean = std::max(0.0, known_us_ / known_pixels_);
  double us = 0;
  each_block(rect, [&](std::size_t block, double area) {
    us += area * (us_per_pixel_[block] >= 0 ? us_per_pixel_[block] : mean);
  });
  return us;
}

void CostImage::warp(const Warp& warp) {
  if (warp.taps.size() != us_per_pixel_.size()) return;
  const std::vector<double> before = us_per_pixel_;
  known_pixels_ = known_us_ = 0;
  std::fill(us_per_pixel_.begin(), us_per_pixel_.end(), kUnknown);
  each_block({0, 0, image_.width, image_.height}, [&](std::size_t block, double area) {
    const Warp::Tap& tap = warp.taps[block];
    double weight = 0, sum = 0;
    for (std::size_t i = 0; i < tap.block.size(); ++i) {
      if (before[tap.block[i]] < 0) continue;
      weight += tap.weight[i];
      sum += tap.weight[i] * before[tap.block[i]];
    }
    if (weight > 0) set(block, area, sum / weight);
  });
}

}  // namespace goldthread
