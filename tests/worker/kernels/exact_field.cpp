// SPDX-License-Identifier: Apache-2.0
#include "exact_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/scene/camera.h"

namespace goldthread::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

glm::dmat3 linear_map(const VolumeGeometry& geometry) {
  return glm::dmat3(geometry.direction[0] * geometry.spacing_mm[0],
                    geometry.direction[1] * geometry.spacing_mm[1],
                    geometry.direction[2] * geometry.spacing_mm[2]);
}

}  // namespace

struct Cubic {
  std::array<double, 4> c;

  // From values at 0, 1/3, 2/3 and 1.
  static Cubic through(const std::array<double, 4>& f) {
    return {{f[0], (-11 * f[0] + 18 * f[1] - 9 * f[2] + 2 * f[3]) / 2,
             (18 * f[0] - 45 * f[1] + 36 * f[2] - 9 * f[3]) / 2,
             (-9 * f[0] + 27 * f[1] - 27 * f[2] + 9 * f[3]) / 2}};
  }
  double operator()(double s) const { return ((c[3] * s + c[2]) * s + c[1]) * s + c[0]; }
  double slope(double s) const { return (3 * c[3] * s + 2 * c[2]) * s + c[1]; }

  // 0, the turns in (0, 1) in order, and 1: `count` places, monotone in between.
  std::array<double, 4> pieces(std::size_t& count) const {
    std::array<double, 4> ends{0, 0, 0, 0};
    count = 1;
    const double a = 3 * c[3], b = c[2], d = c[1];  // a·s² + 2b·s + d
    const double discriminant = b * b - a * d;
    if (discriminant > 0) {
      const double q = -(b + std::copysign(std::sqrt(discriminant), b));
      double turns[2] = {a != 0 ? q / a : -1, q != 0 ? d / q : -1};
      if (turns[0] > turns[1]) std::swap(turns[0], turns[1]);
      for (const double turn : turns)
        if (turn > 0 && turn < 1) ends[count++] = turn;
    }
    ends[count++] = 1;
    return ends;
  }

  // The root between two places of different sign.
  double root(double low, double high) const {
    const bool below = (*this)(low) < 0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      ((((*this)(middle) < 0) == below) ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
};

IndexRay index_ray(const Scene& scene, const VolumeGeometry& geometry, PixelPosition position) {
  const Ray ray = camera_ray(*scene.camera, scene.image.size, position.x, position.y);
  const glm::dmat3 index_from_world = glm::inverse(linear_map(geometry));
  return {index_from_world * (ray.origin - geometry.origin_mm), index_from_world * ray.direction,
          ray.direction};
}

ExactField::ExactField(const Volume& volume)
    : geometry_(volume.info().geometry),
      world_from_index_(linear_map(geometry_)),
      covector_map_(glm::transpose(glm::inverse(world_from_index_))),
      voxels_(reference::voxels_of(volume)) {}

std::vector<CellSpan> ExactField::spans(const IndexRay& ray) const {
  double entry = 0, exit = kInfinity;
  for (int a = 0; a < 3; ++a) {
    const double extent = geometry_.size[a] - 1, o = ray.origin[a], d = ray.direction[a];
    if (extent < 1) return {};
    if (d == 0) {
      if (o < 0 || o > extent) return {};
      continue;
    }
    entry = std::max(entry, std::min(-o / d, (extent - o) / d));
    exit = std::min(exit, std::max(-o / d, (extent - o) / d));
  }
  if (!(exit > entry)) return {};
  std::vector<double> ends{entry, exit};
  for (int a = 0; a < 3; ++a) {
    if (ray.direction[a] == 0) continue;
    for (int plane = 1; plane < geometry_.size[a] - 1; ++plane)
      if (const double t = (plane - ray.origin[a]) / ray.direction[a]; t > entry && t < exit)
        ends.push_back(t);
  }
  std::sort(ends.begin(), ends.end());
  std::vector<CellSpan> spans;
  for (std::size_t i = 1; i < ends.size(); ++i) {
    if (!(ends[i] > ends[i - 1])) continue;
    const glm::dvec3 middle = ray.at(0.5 * (ends[i - 1] + ends[i]));
    const glm::ivec3 cell =
        glm::clamp(glm::ivec3(glm::floor(middle)), glm::ivec3(0), geometry_.size - 2);
    spans.push_back({cell, ends[i - 1], ends[i]});
  }
  return spans;
}

double ExactField::voxel(const glm::ivec3& at) const {
  return voxels_[(std::size_t(at.z) * std::size_t(geometry_.size.y) + std::size_t(at.y)) *
                     std::size_t(geometry_.size.x) +
                 std::size_t(at.x)];
}

bool ExactField::is_finite(const glm::ivec3& cell) const {
  for (int n = 0; n < 8; ++n)
    if (!std::isfinite(voxel(cell + glm::ivec3(n & 1, n >> 1 & 1, n >> 2)))) return false;
  return true;
}

double ExactField::value(const glm::ivec3& cell, const glm::dvec3& index) const {
  const glm::dvec3 f = index - glm::dvec3(cell);
  const auto along_x = [&](int j, int k) {
    const double a = voxel(cell + glm::ivec3(0, j, k)), b = voxel(cell + glm::ivec3(1, j, k));
    return a * (1 - f.x) + b * f.x;
  };
  return (along_x(0, 0) * (1 - f.y) + along_x(1, 0) * f.y) * (1 - f.z) +
         (along_x(0, 1) * (1 - f.y) + along_x(1, 1) * f.y) * f.z;
}

glm::dvec3 ExactField::central_difference(const glm::ivec3& at) const {
  glm::dvec3 difference;
  for (int a = 0; a < 3; ++a) {
    glm::ivec3 low = at, high = at;
    low[a] = std::max(at[a] - 1, 0);
    high[a] = std::min(at[a] + 1, geometry_.size[a] - 1);
    difference[a] = 0.5 * (voxel(high) - voxel(low));
  }
  return difference;
}

glm::dvec3 ExactField::gradient(const glm::ivec3& cell, const glm::dvec3& index) const {
  const glm::dvec3 f = index - glm::dvec3(cell);
  glm::dvec3 gradient(0);
  for (int n = 0; n < 8; ++n) {
    const glm::ivec3 corner(n & 1, n >> 1 & 1, n >> 2);
    const glm::dvec3 weight = glm::mix(1.0 - f, f, glm::dvec3(corner));
    gradient += weight.x * weight.y * weight.z * central_difference(cell + corner);
  }
  return covector_map_ * gradient;
}

Cubic ExactField::cubic_in(const IndexRay& ray, const CellSpan& span, double level) const {
  std::array<double, 4> f{};
  for (std::size_t i = 0; i < 4; ++i) {
    const double t = span.begin_mm + (span.end_mm - span.begin_mm) * double(i) / 3;
    f[i] = value(span.cell, ray.at(t)) - level;
  }
  return Cubic::through(f);
}

std::vector<Place> ExactField::turns(const IndexRay& ray) const {
  std::vector<Place> places;
  for (const CellSpan& span : spans(ray)) {
    if (!is_finite(span.cell)) continue;
    const Cubic cubic = cubic_in(ray, span, 0);
    std::size_t count = 0;
    const std::array<double, 4> ends = cubic.pieces(count);
    for (std::size_t i = 0; i < count; ++i)
      places.push_back({span.begin_mm + ends[i] * (span.end_mm - span.begin_mm), cubic(ends[i])});
  }
  return places;
}

Crossings ExactField::crossings(const IndexRay& ray, double isovalue) const {
  Crossings result;
  const double cells_per_mm = glm::length(ray.direction);
  const std::vector<CellSpan> all = spans(ray);
  double slope_before = 0;
  for (const CellSpan& span : all) {
    if (!is_finite(span.cell)) {
      slope_before = 0;
      continue;
    }
    double least = kInfinity, greatest = -kInfinity;
    for (int n = 0; n < 8; ++n) {
      const double v = voxel(span.cell + glm::ivec3(n & 1, n >> 1 & 1, n >> 2));
      least = std::min(least, v), greatest = std::max(greatest, v);
    }
    if (!(least < greatest)) {
      slope_before = 0;
      continue;
    }
    const double length = span.end_mm - span.begin_mm;
    const Cubic cubic = cubic_in(ray, span, isovalue);
    std::size_t count = 0;
    const std::array<double, 4> ends = cubic.pieces(count);
    // The field turns inside the cell, at a face between two cells, or where the ray ends.
    const bool turns = slope_before * cubic.slope(0) <= 0;
    for (std::size_t i = turns ? 0 : 1; i + 1 < count; ++i)
      result.clearance = std::min(result.clearance, std::abs(cubic(ends[i])) / (greatest - least));
    slope_before = cubic.slope(1);
    if (&span == &all.back())
      result.clearance = std::min(result.clearance, std::abs(cubic(1)) / (greatest - least));
    for (std::size_t i = 1; i < count; ++i) {
      const bool below = cubic(ends[i - 1]) < 0;
      if (below == (cubic(ends[i]) < 0)) continue;
      const double s = cubic.root(ends[i - 1], ends[i]);
      const double slope = std::abs(cubic.slope(s)) / (length * cells_per_mm);
      result.hits.push_back({span.begin_mm + s * length, below, slope / (greatest - least)});
    }
  }
  return result;
}

}  // namespace goldthread::test
