// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "common/scene/scene.h"

namespace goldthread {
namespace {

/// The greatest opacity per unit distance: keeps the extinction of an opaque node finite.
constexpr double kOpacityCap = 1 - 1e-6;

/// Linear between the two nodes around `value`, constant outside. `get` reads a node's payload.
template <class Node, class Get>
auto interpolate(const std::vector<Node>& nodes, double value, Get get) {
  const auto above = std::upper_bound(nodes.begin(), nodes.end(), value,
                                      [](double v, const Node& node) { return v < node.value; });
  if (above == nodes.begin()) return get(nodes.front());
  const Node& below = *(above - 1);
  if (above == nodes.end()) return get(below);
  const double share = (value - below.value) / (above->value - below.value);
  return get(below) + (get(*above) - get(below)) * share;
}

}  // namespace

glm::dvec3 TransferFunction::color_at(double value) const {
  if (color.empty()) return {0, 0, 0};
  return interpolate(color, value, [](const ColorNode& node) { return node.rgb; });
}

double TransferFunction::opacity_at(double value) const {
  if (opacity.empty() || std::isnan(value)) return 0;
  return interpolate(opacity, value, [](const OpacityNode& node) { return node.alpha; });
}

double TransferFunction::extinction_at(double value) const {
  // log1p keeps every digit of small opacities, where log(1 − α) would lose them.
  return -std::log1p(-std::min(opacity_at(value), kOpacityCap)) / unit_distance_mm;
}

}  // namespace goldthread
