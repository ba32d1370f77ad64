// SPDX-License-Identifier: Apache-2.0
#include "common/scene/resolve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace goldthread {
namespace {

constexpr double kDefaultFovyDeg = 30;
/// How far the default camera is turned to the subject's left, and raised.
constexpr double kTurnDeg = 25;
constexpr double kRaiseDeg = 12;
/// A volume flatter than this share of its greatest extent is looked at from its flat side.
constexpr double kFlat = 0.05;
/// The extent's diagonal over the unit distance: 1 mm for a head of 330 mm.
constexpr double kUnitsPerDiagonal = 330;
/// With no more different values than this, integers are taken for labels.
constexpr std::size_t kMostLabels = 24;

struct Extent {
  glm::dvec3 center{0, 0, 0};
  glm::dvec3 size{0, 0, 0};  ///< of the axis-aligned box in the world
  double radius = 0;         ///< of the sphere through the furthest corners
};

Extent extent_of(const VolumeGeometry& geometry) {
  const glm::dvec3 last = glm::dvec3(glm::max(geometry.size - 1, glm::ivec3(0)));
  const auto world = [&](const glm::dvec3& index) {
    return geometry.origin_mm + geometry.direction * (geometry.spacing_mm * index);
  };
  Extent extent;
  extent.center = world(last * 0.5);
  glm::dvec3 low = extent.center, high = extent.center;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 pick(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    const glm::dvec3 at = world(last * pick);
    low = glm::min(low, at);
    high = glm::max(high, at);
    extent.radius = std::max(extent.radius, glm::length(at - extent.center));
  }
  extent.size = high - low;
  // A single voxel has no extent between centres; show what is around it.
  if (extent.radius == 0) extent.radius = glm::length(geometry.spacing_mm) / 2;
  return extent;
}

Camera default_camera(const VolumeGeometry& geometry, ImageSize size) {
  const Extent extent = extent_of(geometry);
  Camera camera;
  camera.fovy_deg = kDefaultFovyDeg;
  camera.target = extent.center;
  // The narrower side of the picture must hold the sphere.
  const double aspect = std::min(1.0, static_cast<double>(size.width) / size.height);
  const double half_angle = std::atan(std::tan(glm::radians(kDefaultFovyDeg) / 2) * aspect);
  const double distance = extent.radius / std::sin(half_angle);
  const bool flat = extent.size.z < kFlat * std::max(extent.size.x, extent.size.y);
  if (flat) {
    camera.up = {0, -1, 0};
    camera.position = camera.target - glm::dvec3(0, 0, distance);
    return camera;
  }
  const double turn = glm::radians(kTurnDeg), raise = glm::radians(kRaiseDeg);
  camera.up = {0, 0, 1};
  camera.position =
      camera.target + distance * glm::dvec3(std::sin(turn) * std::cos(raise),
                                            -std::cos(turn) * std::cos(raise), std::sin(raise));
  return camera;
}

/// The middle of a histogram bin as a data value.
double bin_value(const VolumeInfo& info, double bin) {
  const double width = (info.maximum - info.minimum) / static_cast<double>(info.histogram.size());
  return info.minimum + (bin + 0.5) * width;
}

bool is_constant(const VolumeInfo& info) {
  return info.histogram.empty() || !(info.maximum > info.minimum);
}

/// Otsu's threshold as the last bin of the background: the cut with the greatest variance between
/// the two sides' means.
std::size_t otsu_bin(const std::vector<std::uint64_t>& histogram) {
  double total = 0, total_moment = 0;
  for (std::size_t i = 0; i < histogram.size(); ++i) {
    total += static_cast<double>(histogram[i]);
    total_moment += static_cast<double>(histogram[i]) * static_cast<double>(i);
  }
  std::size_t first_best = 0, last_best = 0;
  double best = -1, below = 0, moment = 0;
  for (std::size_t i = 0; i + 1 < histogram.size(); ++i) {
    below += static_cast<double>(histogram[i]);
    moment += static_cast<double>(histogram[i]) * static_cast<double>(i);
    const double above = total - below;
    if (below == 0 || above == 0) continue;
    const double apart = moment / below - (total_moment - moment) / above;
    const double variance = below * above * apart * apart;
    if (variance > best) {
      best = variance;
      first_best = i;
    }
    if (variance == best) last_best = i;
  }
  // Across a gap every cut is as good: take its middle.
  return (first_best + last_best) / 2;
}

/// The value below which `share` of the voxels above bin `from` lie.
double foreground_quantile(const VolumeInfo& info, std::size_t from, double share) {
  const auto begin = info.histogram.begin() + static_cast<std::ptrdiff_t>(from) + 1;
  const double total =
      static_cast<double>(std::accumulate(begin, info.histogram.end(), std::uint64_t{0}));
  double sum = 0;
  for (std::size_t i = from + 1; i < info.histogram.size(); ++i) {
    sum += static_cast<double>(info.histogram[i]);
    if (sum >= share * total) return bin_value(info, static_cast<double>(i));
  }
  return info.maximum;
}

/// The different values of an integer volume with few of them, else nothing. Only where a bin is
/// no wider than one value can the histogram tell them apart.
std::vector<double> label_values(const VolumeInfo& info) {
  std::vector<double> values;
  const double range = info.maximum - info.minimum;
  if (info.type == VoxelType::kFloat32 || info.histogram.size() < 2 ||
      range > static_cast<double>(info.histogram.size()) - 1) {
    return values;
  }
  for (std::size_t i = 0; i < info.histogram.size(); ++i) {
    if (info.histogram[i] == 0) continue;
    const double value =
        std::clamp(std::round(bin_value(info, static_cast<double>(i))), info.minimum, info.maximum);
    if (values.empty() || value > values.back()) values.push_back(value);
  }
  if (values.size() > kMostLabels) values.clear();
  return values;
}

/// Hues a golden section apart, so that neighbours differ.
glm::dvec3 label_color(std::size_t index) {
  const double hue = std::fmod(0.08 + 0.618034 * static_cast<double>(index), 1.0);
  const auto channel = [&](double offset) {
    const double k = std::fmod(offset + hue * 6, 6.0);
    return 0.95 - 0.55 * std::clamp(std::min(k, 4 - k), 0.0, 1.0);
  };
  return {channel(5), channel(3), channel(1)};
}

/// Steps half-way between neighbouring labels; the least label is the background.
TransferFunction label_function(const std::vector<double>& values) {
  TransferFunction function;
  function.color = {{values[0], {0, 0, 0}}};
  function.opacity = {{values[0], 0}};
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double edge = (values[i - 1] + values[i]) / 2;
    const glm::dvec3 before = i == 1 ? label_color(1) : function.color.back().rgb;
    function.color.push_back({edge, before});
    function.color.push_back({edge, label_color(i)});
  }
  const double first_edge = (values[0] + values[1]) / 2;
  function.opacity.push_back({first_edge, 0});
  function.opacity.push_back({first_edge, 0.15});
  return function;
}

TransferFunction ramp_function(const VolumeInfo& info) {
  const std::size_t cut = otsu_bin(info.histogram);
  const double edge = bin_value(info, static_cast<double>(cut) + 0.5);
  const double half = foreground_quantile(info, cut, 0.5);
  const double most = foreground_quantile(info, cut, 0.95);
  // The ramp starts below the cut, where the background's noise has mostly ended, so that the
  // surface is soft.
  const double start = edge - (edge - info.minimum) * 0.3;
  TransferFunction function;
  function.color = {{info.minimum, {0.25, 0.08, 0.05}},
                    {edge, {0.72, 0.36, 0.26}},
                    {half, {0.92, 0.68, 0.52}},
                    {most, {0.98, 0.91, 0.80}},
                    {info.maximum, {1, 1, 1}}};
  function.opacity = {{info.minimum, 0}, {start, 0},   {edge, 0.02},
                      {half, 0.12},      {most, 0.25}, {info.maximum, 0.4}};
  return function;
}

template <class Node>
void stretch(std::vector<Node>& nodes, const VolumeInfo& info) {
  const double width = info.maximum > info.minimum ? info.maximum - info.minimum : 1;
  for (Node& node : nodes) node.value = info.minimum + node.value * width;
}

}  // namespace

double foreground_threshold(const VolumeInfo& info) {
  if (is_constant(info)) return info.minimum;
  return bin_value(info, static_cast<double>(otsu_bin(info.histogram)) + 0.5);
}

TransferFunction default_transfer_function(const VolumeInfo& info) {
  TransferFunction function;
  const std::vector<double> labels = label_values(info);
  if (is_constant(info)) {
    function.color = {{info.minimum, {0.92, 0.68, 0.52}}};
    function.opacity = {{info.minimum, 0.01}};
  } else if (labels.size() >= 2) {
    function = label_function(labels);
  } else {
    function = ramp_function(info);
  }
  function.unit_distance_mm = 2 * extent_of(info.geometry).radius / kUnitsPerDiagonal;
  return function;
}

Scene resolve_scene(const Scene& scene, const VolumeInfo& info) {
  Scene resolved = scene;
  if (!resolved.camera) {
    resolved.camera = default_camera(info.geometry, resolved.image.size);
  }
  for (SceneVolume& volume : resolved.volumes) {
    if (!volume.transfer_function) volume.transfer_function = default_transfer_function(info);
    TransferFunction& function = *volume.transfer_function;
    if (function.color_spans_range) stretch(function.color, info);
    if (function.opacity_spans_range) stretch(function.opacity, info);
    function.color_spans_range = function.opacity_spans_range = false;
    if (function.opacity.empty()) function.opacity = default_transfer_function(info).opacity;
    if (volume.mode == Mode::kIsosurface && volume.isosurfaces.empty()) {
      volume.isosurfaces.push_back({.value = foreground_threshold(info)});
    }
  }
  return resolved;
}

}  // namespace goldthread
