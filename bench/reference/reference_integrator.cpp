// SPDX-License-Identifier: Apache-2.0
#include "bench/reference/reference_integrator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace goldthread::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPi = 3.14159265358979323846;

double to_linear(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }
glm::dvec3 to_linear(const glm::dvec3& v) {
  return {to_linear(v.x), to_linear(v.y), to_linear(v.z)};
}

glm::dvec3 unit(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 ? v / length : glm::dvec3(0);
}

// Piecewise linear through nodes (value, payload), searched from the end: the later of two nodes
// of equal value holds.
template <class Node, class Payload>
Payload along_nodes(const std::vector<Node>& nodes, double value, Payload Node::*payload) {
  if (nodes.empty()) return Payload(0);
  for (std::size_t i = nodes.size(); i-- > 0;) {
    if (value < nodes[i].value) continue;
    if (i + 1 == nodes.size()) return nodes[i].*payload;
    const double share = (value - nodes[i].value) / (nodes[i + 1].value - nodes[i].value);
    return nodes[i].*payload * (1 - share) + nodes[i + 1].*payload * share;
  }
  return nodes.front().*payload;
}

// The cubic that a trilinear field is along a ray inside a cell, over s in [0, 1]: coefficients of
// 1, s, s², s³ from values at 0, 1/3, 2/3, 1.
std::array<double, 4> cubic_through(const std::array<double, 4>& f) {
  const double c1 = (-11 * f[0] + 18 * f[1] - 9 * f[2] + 2 * f[3]) / 2;
  const double c2 = (18 * f[0] - 45 * f[1] + 36 * f[2] - 9 * f[3]) / 2;
  const double c3 = (-9 * f[0] + 27 * f[1] - 27 * f[2] + 9 * f[3]) / 2;
  return {f[0], c1, c2, c3};
}

double evaluate(const std::array<double, 4>& c, double s) {
  return ((c[3] * s + c[2]) * s + c[1]) * s + c[0];
}

// 0, the places in (0, 1) where the cubic turns, and 1: monotone in between.
std::vector<double> monotone_pieces(const std::array<double, 4>& c) {
  std::vector<double> ends{0};
  const double a = 3 * c[3], b = 2 * c[2], d = c[1];
  std::vector<double> turns;
  if (std::abs(a) < 1e-14 * (std::abs(b) + std::abs(d))) {
    if (b != 0) turns = {-d / b};
  } else if (const double discriminant = b * b - 4 * a * d; discriminant > 0) {
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    turns = {q / a};
    if (q != 0) turns.push_back(d / q);
  }
  std::sort(turns.begin(), turns.end());
  for (const double turn : turns)
    if (turn > 0 && turn < 1) ends.push_back(turn);
  ends.push_back(1);
  return ends;
}

double bisect(const std::array<double, 4>& c, double low, double high, double level) {
  const bool rising = evaluate(c, low) < level;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    ((evaluate(c, middle) < level) == rising ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

Integrator::Integrator(Scene scene, VolumeGeometry geometry, std::vector<double> voxels,
                       int substeps)
    : scene_(std::move(scene)),
      material_(scene_.volumes.front()),
      geometry_(geometry),
      voxels_(std::move(voxels)),
      substeps_(substeps),
      world_from_index_(geometry.direction[0] * geometry.spacing_mm[0],
                        geometry.direction[1] * geometry.spacing_mm[1],
                        geometry.direction[2] * geometry.spacing_mm[2]) {
  if (scene_.image.color_space == ColorSpace::kDisplay) return;
  for (Light& light : scene_.lights) light.color = to_linear(light.color);
  if (material_.transfer_function)
    for (ColorNode& node : material_.transfer_function->color) node.rgb = to_linear(node.rgb);
  for (Isosurface& surface : material_.isosurfaces) surface.color = to_linear(surface.color);
}

Radiance Integrator::cast(double x, double y) const {
  const Ray ray = ray_through(x, y);
  const std::vector<double> ends = crossings(ray);
  Path path;
  path.greatest = -kInfinity;
  for (std::size_t i = 1; i < ends.size(); ++i)
    if (ends[i] > ends[i - 1]) cross_cell(ray, ends[i - 1], ends[i], path);
  if (material_.mode == Mode::kMip) {
    if (path.greatest == -kInfinity) return {};
    return {color_of(path.greatest), 1};
  }
  return {path.color, 1 - path.transmittance};
}

Integrator::Ray Integrator::ray_through(double x, double y) const {
  const Camera& camera = *scene_.camera;
  const glm::dvec3 forward = unit(camera.target - camera.position);
  const glm::dvec3 right = unit(glm::cross(forward, camera.up));
  const glm::dvec3 up = glm::cross(right, forward);
  const double half_height = 0.5 * scene_.image.size.height;
  const double scale = std::tan(camera.fovy_deg * kPi / 360) / half_height;
  Ray ray;
  ray.origin = camera.position;
  ray.direction = unit(forward + right * ((x - 0.5 * scene_.image.size.width) * scale) +
                       up * ((half_height - y) * scale));
  const glm::dmat3 index_from_world = glm::inverse(world_from_index_);
  ray.index_origin = index_from_world * (ray.origin - geometry_.origin_mm);
  ray.index_direction = index_from_world * ray.direction;
  return ray;
}

// Where the ray enters the volume, where it crosses planes of voxel centres, and where it leaves.
std::vector<double> Integrator::crossings(const Ray& ray) const {
  double entry = 0, exit = kInfinity;
  for (int a = 0; a < 3; ++a) {
    const double extent = geometry_.size[a] - 1;
    const double o = ray.index_origin[a], d = ray.index_direction[a];
    if (extent <= 0) return {};
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
    const double o = ray.index_origin[a], d = ray.index_direction[a];
    if (d == 0) continue;
    for (int plane = 1; plane < geometry_.size[a] - 1; ++plane)
      if (const double t = (plane - o) / d; t > entry && t < exit) ends.push_back(t);
  }
  std::sort(ends.begin(), ends.end());
  return ends;
}

void Integrator::cross_cell(const Ray& ray, double begin, double end, Path& path) const {
  const glm::ivec3 cell = cell_at(ray.index_origin + ray.index_direction * (0.5 * (begin + end)));
  if (!cell_is_finite(cell)) return;
  if (material_.mode == Mode::kMip) {
    std::array<double, 4> f{};
    for (int i = 0; i < 4; ++i)
      f[i] = value_in(cell,
                      ray.index_origin + ray.index_direction * (begin + (end - begin) * i / 3.0));
    const auto cubic = cubic_through(f);
    for (const double s : monotone_pieces(cubic))
      path.greatest = std::max(path.greatest, evaluate(cubic, s));
    return;
  }
  if (path.transmittance < 1e-12) return;
  const bool dvr = material_.mode == Mode::kDvr && !cell_is_transparent(cell);
  double from = begin;
  for (const Hit& hit : hits_in(ray, begin, end)) {
    if (dvr) integrate(ray, from, hit.t, substeps_, path);
    const double weight = path.transmittance * std::clamp(hit.surface->opacity, 0.0, 1.0);
    path.color += weight * lit(ray, hit.t, hit.surface->color);
    path.transmittance -= weight;
    from = hit.t;
  }
  if (dvr) integrate(ray, from, end, substeps_, path);
}

void Integrator::integrate(const Ray& ray, double begin, double end, int substeps,
                           Path& path) const {
  const double length = (end - begin) / substeps;
  for (int i = 0; i < substeps; ++i) {
    const double t = begin + (i + 0.5) * length;
    const double value = value_at(ray.index_origin + ray.index_direction * t);
    const double extinction = extinction_of(value);
    if (!(extinction > 0)) continue;
    const double weight = path.transmittance * -std::expm1(-extinction * length);
    path.color += weight * lit(ray, t, color_of(value));
    path.transmittance -= weight;
  }
}

std::vector<Integrator::Hit> Integrator::hits_in(const Ray& ray, double begin, double end) const {
  std::vector<Hit> hits;
  if (material_.isosurfaces.empty()) return hits;
  std::array<double, 4> f{};
  const glm::ivec3 cell = cell_at(ray.index_origin + ray.index_direction * (0.5 * (begin + end)));
  for (int i = 0; i < 4; ++i)
    f[i] =
        value_in(cell, ray.index_origin + ray.index_direction * (begin + (end - begin) * i / 3.0));
  const auto cubic = cubic_through(f);
  const auto pieces = monotone_pieces(cubic);
  for (const Isosurface& surface : material_.isosurfaces)
    for (std::size_t i = 1; i < pieces.size(); ++i) {
      const bool below = evaluate(cubic, pieces[i - 1]) < surface.value;
      if (below == (evaluate(cubic, pieces[i]) < surface.value)) continue;
      const double s = bisect(cubic, pieces[i - 1], pieces[i], surface.value);
      hits.push_back({begin + s * (end - begin), &surface});
    }
  std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return a.t < b.t; });
  return hits;
}

double Integrator::voxel(int i, int j, int k) const {
  return voxels_[(std::size_t(k) * std::size_t(geometry_.size.y) + std::size_t(j)) *
                     std::size_t(geometry_.size.x) +
                 std::size_t(i)];
}

glm::ivec3 Integrator::cell_at(const glm::dvec3& position) const {
  return glm::clamp(glm::ivec3(glm::floor(position)), glm::ivec3(0), geometry_.size - 2);
}

bool Integrator::cell_is_finite(const glm::ivec3& c) const {
  for (int n = 0; n < 8; ++n)
    if (!std::isfinite(voxel(c.x + (n & 1), c.y + (n >> 1 & 1), c.z + (n >> 2)))) return false;
  return true;
}

// Exact: opacity between two values is greatest at one of them or at a node between.
bool Integrator::cell_is_transparent(const glm::ivec3& c) const {
  double least = kInfinity, greatest = -kInfinity;
  for (int n = 0; n < 8; ++n) {
    const double v = voxel(c.x + (n & 1), c.y + (n >> 1 & 1), c.z + (n >> 2));
    least = std::min(least, v);
    greatest = std::max(greatest, v);
  }
  if (extinction_of(least) > 0 || extinction_of(greatest) > 0) return false;
  for (const OpacityNode& node : material_.transfer_function->opacity)
    if (node.alpha > 0 && node.value >= least && node.value <= greatest) return false;
  return true;
}

double Integrator::value_in(const glm::ivec3& c, const glm::dvec3& position) const {
  const glm::dvec3 f = position - glm::dvec3(c);
  double value = 0;
  for (int n = 0; n < 8; ++n) {
    const int i = n & 1, j = n >> 1 & 1, k = n >> 2;
    value += (i ? f.x : 1 - f.x) * (j ? f.y : 1 - f.y) * (k ? f.z : 1 - f.z) *
             voxel(c.x + i, c.y + j, c.z + k);
  }
  return value;
}

double Integrator::value_at(const glm::dvec3& position) const {
  return value_in(cell_at(position), position);
}

// Half the difference of the two neighbours, the border's voxel repeated beyond it; per voxel.
glm::dvec3 Integrator::central_difference(const glm::ivec3& at) const {
  glm::dvec3 difference;
  for (int a = 0; a < 3; ++a) {
    glm::ivec3 low = at, high = at;
    low[a] = std::max(at[a] - 1, 0);
    high[a] = std::min(at[a] + 1, geometry_.size[a] - 1);
    difference[a] = 0.5 * (voxel(high.x, high.y, high.z) - voxel(low.x, low.y, low.z));
  }
  return difference;
}

glm::dvec3 Integrator::world_gradient(const glm::dvec3& position) const {
  const glm::ivec3 c = cell_at(position);
  const glm::dvec3 f = position - glm::dvec3(c);
  glm::dvec3 gradient(0);
  for (int n = 0; n < 8; ++n) {
    const int i = n & 1, j = n >> 1 & 1, k = n >> 2;
    gradient += (i ? f.x : 1 - f.x) * (j ? f.y : 1 - f.y) * (k ? f.z : 1 - f.z) *
                central_difference({c.x + i, c.y + j, c.z + k});
  }
  return glm::transpose(glm::inverse(world_from_index_)) * gradient;
}

glm::dvec3 Integrator::lit(const Ray& ray, double t, const glm::dvec3& color) const {
  if (!material_.shading) return color;
  const Shading& phong = *material_.shading;
  const glm::dvec3 index = ray.index_origin + ray.index_direction * t;
  const glm::dvec3 gradient = world_gradient(index);
  if (!(glm::length(gradient) > 0)) return color * phong.ambient;
  const glm::dvec3 n = unit(gradient), v = -ray.direction;
  const glm::dvec3 position = geometry_.origin_mm + world_from_index_ * index;
  glm::dvec3 scale(phong.ambient), shine(0);
  for (const Light& light : scene_.lights) {
    glm::dvec3 l = unit(scene_.camera->position - scene_.camera->target);
    if (const auto* d = std::get_if<DirectionalLight>(&light.kind)) l = -unit(d->direction);
    if (const auto* p = std::get_if<PointLight>(&light.kind)) l = unit(p->position_mm - position);
    const glm::dvec3 r = 2 * glm::dot(n, l) * n - l;
    const glm::dvec3 power = light.intensity * light.color;
    scale += power * (phong.diffuse * std::abs(glm::dot(n, l)));
    shine += power * (phong.specular * std::pow(std::abs(glm::dot(r, v)), phong.shininess));
  }
  return color * scale + shine;
}

glm::dvec3 Integrator::color_of(double value) const {
  return along_nodes(material_.transfer_function->color, value, &ColorNode::rgb);
}

double Integrator::extinction_of(double value) const {
  const double alpha =
      along_nodes(material_.transfer_function->opacity, value, &OpacityNode::alpha);
  return -std::log1p(-std::min(alpha, 1 - 1e-6)) / material_.transfer_function->unit_distance_mm;
}

std::vector<double> voxels_of(const Volume& volume) {
  const glm::ivec3 size = volume.info().geometry.size;
  std::vector<double> voxels;
  voxels.reserve(volume.info().geometry.voxel_count());
  for (int k = 0; k < size.z; ++k)
    for (int j = 0; j < size.y; ++j)
      for (int i = 0; i < size.x; ++i) voxels.push_back(volume.at(i, j, k));
  return voxels;
}

}  // namespace goldthread::reference
