// SPDX-License-Identifier: Apache-2.0
#include "error_bound.h"

#include <algorithm>
#include <cmath>

namespace goldthread::test {
namespace {

constexpr int kPerStep = 6;
constexpr double kUnseen = 1.0 / 1024;
constexpr double kFloat = 0x1p-24;

glm::dvec3 unit(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 ? v / length : glm::dvec3(0);
}

}  // namespace

ErrorBound::ErrorBound(const Scene& scene, const Volume& volume, int reference_substeps)
    : scene_(scene),
      material_(scene_.volumes.front()),
      field_(volume),
      substeps_(reference_substeps) {
  const VolumeInfo& info = volume.info();
  const double bias = volume.value_bias();
  const double greatest = std::max(std::abs(info.minimum - bias), std::abs(info.maximum - bias));
  const double range = info.maximum - info.minimum;
  value_unsure_ = 4 * kFloat * greatest;
  table_distance_ = range / 2048;
  if (info.type != VoxelType::kFloat32) table_distance_ = std::min(table_distance_, 1.0);
  const glm::dmat3& map = field_.world_from_index();
  const double finest = std::min({glm::length(map[0]), glm::length(map[1]), glm::length(map[2])});
  const double skew = glm::length(map[0]) * glm::length(map[1]) * glm::length(map[2]) /
                      std::abs(glm::determinant(map));
  normal_unsure_ = 8 * kFloat * greatest * skew / finest;
  const TransferFunction& function = *material_.transfer_function;
  for (const ColorNode& node : function.color)
    node_optics_.emplace_back(node.value, optics(node.value));
  for (const OpacityNode& node : function.opacity) {
    TransferFunction flat = function;
    flat.opacity = {node};
    const double extinction = flat.extinction_at(node.value);
    node_optics_.emplace_back(node.value,
                              glm::dvec4(function.color_at(node.value) * extinction, extinction));
  }
}

// Where the field turns between two points, or the ray runs through a peak of the transfer
// function, or a cell is so short that no point lies in it.
void ErrorBound::add_what_lies_between(const IndexRay& ray, double entry, double distance,
                                       std::vector<Point>& points) const {
  const std::size_t count = points.size();
  std::vector<std::vector<double>> values(count);  // met near each point
  for (std::size_t i = 0; i < count; ++i)
    for (const std::size_t j : {i, i + 1})
      if (j > 0 && j < count && points[j - 1].finite && points[j].finite)
        values[i].push_back(points[j == i ? i - 1 : i + 1].value);
  std::vector<glm::dvec4> unsure(count, glm::dvec4(0));
  const auto here = [&](std::size_t i) {
    return points[i].finite ? optics(points[i].value) : glm::dvec4(0);
  };
  for (const Place& place : field_.turns(ray)) {
    const auto i = std::size_t(std::clamp((place.t_mm - entry) / distance, 0.0, double(count) - 1));
    values[i].push_back(place.value);
    unsure[i] = glm::max(unsure[i], glm::abs(optics(place.value) - here(i)));
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (points[i].finite) values[i].push_back(points[i].value);
    if (values[i].empty()) continue;
    const auto [low, high] = std::minmax_element(values[i].begin(), values[i].end());
    for (const auto& [value, node] : node_optics_)
      if (value > *low && value < *high) unsure[i] = glm::max(unsure[i], glm::abs(node - here(i)));
    points[i].extinction_unsure += unsure[i].w;
    points[i].emission_unsure +=
        glm::dvec3(unsure[i]) * points[i].light.scale + unsure[i].w * points[i].light.shine;
  }
}

glm::dvec4 ErrorBound::optics(double value) const {
  const double extinction = material_.transfer_function->extinction_at(value);
  return {material_.transfer_function->color_at(value) * extinction, extinction};
}

ErrorBound::Lighting ErrorBound::lighting(const IndexRay& ray, const glm::ivec3& cell,
                                          const glm::dvec3& index) const {
  if (!material_.shading) return {};
  const Shading& phong = *material_.shading;
  const glm::dvec3 gradient = field_.gradient(cell, index);
  const double off = std::min(2.0, normal_unsure_ / std::max(glm::length(gradient), 1e-300));
  const glm::dvec3 n = unit(gradient);
  const glm::dvec3 position = field_.geometry().origin_mm + field_.world_from_index() * index;
  Lighting result{glm::dvec3(phong.ambient), glm::dvec3(0), 0};
  for (const Light& light : scene_.lights) {
    const double most = light.intensity * (phong.diffuse + phong.specular * phong.shininess);
    result.unsure += std::min(off * most, light.intensity * (phong.diffuse + phong.specular));
    if (n == glm::dvec3(0)) continue;
    glm::dvec3 l = unit(scene_.camera->position - scene_.camera->target);
    if (const auto* d = std::get_if<DirectionalLight>(&light.kind)) l = -unit(d->direction);
    if (const auto* p = std::get_if<PointLight>(&light.kind)) l = unit(p->position_mm - position);
    const double mirrored = 2 * glm::dot(n, l) * glm::dot(n, ray.world) - glm::dot(l, ray.world);
    const glm::dvec3 power = light.intensity * light.color;
    result.scale += power * (phong.diffuse * std::abs(glm::dot(n, l)));
    result.shine += power * (phong.specular * std::pow(std::abs(mirrored), phong.shininess));
  }
  return result;
}

ErrorBound::Point ErrorBound::point(const IndexRay& ray, double t_mm) const {
  Point result;
  const glm::dvec3 index = ray.at(t_mm);
  const glm::ivec3 cell =
      glm::clamp(glm::ivec3(glm::floor(index)), glm::ivec3(0), field_.geometry().size - 2);
  result.finite = field_.is_finite(cell);
  if (!result.finite) return result;
  result.value = field_.value(cell, index);
  if (material_.mode == Mode::kMip) return result;
  const glm::dvec4 here = optics(result.value);
  // Several distances: a narrow peak must not hide between two of them.
  glm::dvec4 unsure(0);
  for (const double share : {0.25, 0.5, 1.0}) {
    const double away = share * table_distance_ + value_unsure_;
    unsure = glm::max(
        unsure, glm::abs(optics(result.value - away) + optics(result.value + away) - 2.0 * here));
  }
  unsure += glm::abs(optics(result.value + value_unsure_) - here);
  result.extinction = here.w;
  result.extinction_unsure = unsure.w;
  const Lighting light = result.light = lighting(ray, cell, index);
  result.color = material_.transfer_function->color_at(result.value) * light.scale + light.shine;
  result.emission = here.w * result.color;
  result.emission_unsure =
      glm::dvec3(unsure) * light.scale + unsure.w * light.shine + here.w * light.unsure;
  return result;
}

std::vector<ErrorBound::Point> ErrorBound::points_on(const IndexRay& ray, double entry, double exit,
                                                     int count) const {
  std::vector<Point> points;
  points.reserve(std::size_t(count));
  for (int i = 0; i < count; ++i)
    points.push_back(point(ray, entry + (i + 0.5) * (exit - entry) / count));
  if (material_.mode == Mode::kMip) return points;
  add_what_lies_between(ray, entry, (exit - entry) / count, points);
  return points;
}

RayBound ErrorBound::of(PixelPosition position) const {
  const IndexRay ray = index_ray(scene_, field_.geometry(), position);
  const std::vector<CellSpan> spans = field_.spans(ray);
  if (spans.empty()) return {};
  const double entry = spans.front().begin_mm, exit = spans.back().end_mm;
  const int count = std::max(3, int(std::ceil((exit - entry) / scene_.step_mm * kPerStep)));
  const std::vector<Point> points = points_on(ray, entry, exit, count);
  if (material_.mode == Mode::kMip) return of_greatest(points, kPerStep);
  double longest = 0;
  for (const CellSpan& span : spans) longest = std::max(longest, span.end_mm - span.begin_mm);
  // The reference's own error: the same formula for its segments.
  const double ratio = 1 + longest / substeps_ / scene_.step_mm;
  return of_absorption(points, (exit - entry) / count, ratio);
}

RayBound ErrorBound::of_absorption(const std::vector<Point>& points, double distance,
                                   double ratio) const {
  const int count = int(points.size());
  const int reach = kPerStep / 2 + 1;
  std::vector<double> bend(points.size(), 0);
  std::vector<glm::dvec3> emission_bend(points.size(), glm::dvec3(0));
  for (int i = 0; i < count; ++i)
    for (int x = 1; x <= reach; ++x) {
      if (i - x < 0 || i + x >= count) break;
      const Point &here = points[i], &low = points[i - x], &high = points[i + x];
      bend[i] =
          std::max(bend[i], 0.5 * std::abs(low.extinction + high.extinction - 2 * here.extinction));
      emission_bend[i] = glm::max(
          emission_bend[i], 0.5 * glm::abs(low.emission + high.emission - 2.0 * here.emission));
    }
  RayBound bound;
  double depth = 0, off = 0;  // optical depth, and the bound E of its error
  glm::dvec3 brightest(0);
  for (int i = 0; i < count; ++i) {
    double worst = 0, thickest = 0;
    glm::dvec3 emission_worst(0), least(points[i].emission), most(points[i].emission);
    for (int j = std::max(0, i - reach); j <= std::min(count - 1, i + reach); ++j) {
      worst = std::max(worst, bend[j] + points[j].extinction_unsure);
      emission_worst = glm::max(emission_worst, emission_bend[j] + points[j].emission_unsure);
      thickest = std::max(thickest, points[j].extinction + points[j].extinction_unsure);
      least = glm::min(least, points[j].emission), most = glm::max(most, points[j].emission);
      brightest = glm::max(brightest, points[j].color);
    }
    off += ratio * worst * distance;
    const double step_depth = thickest * scene_.step_mm;
    // At the start of the segment that this point lies in.
    const double before = std::min(1.0, std::exp(-depth + off + step_depth));
    const double share = std::min(1.0, std::exp(-depth + off) * std::expm1(off));
    bound.color +=
        distance * (before * ratio * (emission_worst - (most - least) * std::expm1(-step_depth)) +
                    points[i].emission * share);
    depth += points[i].extinction * distance;
  }
  // The points' own depth is not exact either.
  bound.alpha = std::min(1.0, std::exp(-depth + off) * std::expm1(off));
  const double cut = std::exp(-depth - 2 * off) <= kUnseen ? kUnseen : 0;
  const double rounding = (count + 64) * kFloat;
  bound.alpha = std::min(1.0, bound.alpha + cut) + rounding;
  bound.color = glm::min(brightest, bound.color + cut * brightest) + rounding * (brightest + 1.0);
  return bound;
}

RayBound ErrorBound::of_greatest(const std::vector<Point>& points, int per_step) const {
  const double nothing = -HUGE_VAL;
  std::vector<double> found(std::size_t(per_step), nothing);
  double greatest = nothing, steepest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].finite) continue;
    found[i % found.size()] = std::max(found[i % found.size()], points[i].value);
    greatest = std::max(greatest, points[i].value);
    if (i > 0 && points[i - 1].finite)
      steepest = std::max(steepest, std::abs(points[i].value - points[i - 1].value));
  }
  const double least = *std::min_element(found.begin(), found.end());
  // A phase that meets no number at all may show nothing.
  if (least == nothing) return {glm::dvec3(1), 1};
  const double away = table_distance_ + value_unsure_;
  const double low = least - steepest - away, high = greatest + steepest + away;
  const TransferFunction& function = *material_.transfer_function;
  glm::dvec3 darkest = glm::min(function.color_at(low), function.color_at(high));
  glm::dvec3 brightest = glm::max(function.color_at(low), function.color_at(high));
  for (const ColorNode& node : function.color)
    if (node.value >= low && node.value <= high) {
      darkest = glm::min(darkest, node.rgb);
      brightest = glm::max(brightest, node.rgb);
    }
  return {brightest - darkest + 1e-6, 1e-6};
}

}  // namespace goldthread::test
