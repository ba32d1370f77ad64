// SPDX-License-Identifier: Apache-2.0
#include "worker/kernels/transfer_table.h"

#include <algorithm>
#include <cmath>

namespace goldthread {
namespace {

constexpr double kLeastRows = 4096;
constexpr double kMostRows = 65536;
constexpr double kRowsPerGap = 16;  ///< between the two nearest nodes, where kMostRows allows it

struct Domain {
  double first = 0;
  double last = 0;
};

Domain domain_of(const TransferFunction& function, const VolumeInfo& info) {
  Domain nodes{info.maximum, info.minimum};
  for (const ColorNode& node : function.color) {
    nodes.first = std::min(nodes.first, node.value);
    nodes.last = std::max(nodes.last, node.value);
  }
  for (const OpacityNode& node : function.opacity) {
    nodes.first = std::min(nodes.first, node.value);
    nodes.last = std::max(nodes.last, node.value);
  }
  Domain domain{std::max(nodes.first, info.minimum), std::min(nodes.last, info.maximum)};
  if (!(domain.first <= domain.last)) domain = {info.minimum, info.maximum};
  return domain;
}

template <class Node>
double least_gap(const std::vector<Node>& nodes, double bound) {
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    const double gap = nodes[i].value - nodes[i - 1].value;
    if (gap > 0) bound = std::min(bound, gap);
  }
  return bound;
}

double rows_per_value_of(const Domain& domain, const TransferFunction& function, VoxelType type) {
  const double range = domain.last - domain.first;
  if (!(range > 0)) return 1;
  const double gap = least_gap(function.opacity, least_gap(function.color, range));
  const double wanted = std::max(kLeastRows, std::ceil(range / gap * kRowsPerGap));
  const double rows = std::min(kMostRows, wanted);
  if (type == VoxelType::kFloat32) return rows / range;
  return std::max(1.0, std::floor(std::min(rows, kMostRows) / range));
}

/// The segments between a function's colour nodes, and a constant one behind the last; none if they
/// are too many.
ColorSegments segments_of(const std::vector<ColorNode>& nodes, double value_bias, double factor) {
  ColorSegments segments;
  if (nodes.size() > std::size_t(ColorSegments::kMost)) return segments;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const bool last = i + 1 == nodes.size();
    const double width = last ? 0 : nodes[i + 1].value - nodes[i].value;
    if (!last && !(width > 0)) continue;  // a step: the later node holds
    segments.start[segments.count] = float(nodes[i].value - value_bias);
    for (int c = 0; c < 3; ++c) {
      const double slope = last ? 0 : (nodes[i + 1].rgb[c] - nodes[i].rgb[c]) / width;
      segments.color[c][segments.count] = float(nodes[i].rgb[c] * factor);
      segments.slope[c][segments.count] = float(slope * factor);
    }
    ++segments.count;
  }
  return segments;
}

}  // namespace

TransferRows::TransferRows(const TransferFunction& function, const VolumeInfo& info,
                           double value_bias, double color_factor, double step_mm) {
  Domain domain = domain_of(function, info);
  if (info.type != VoxelType::kFloat32) domain = {std::floor(domain.first), std::ceil(domain.last)};
  const double per_value = rows_per_value_of(domain, function, info.type);
  const auto count = std::max<std::size_t>(
      2, std::size_t(std::ceil((domain.last - domain.first) * per_value)) + 1);
  rows_.reserve(count * 4);
  for (std::size_t i = 0; i < count; ++i) {
    const double value = domain.first + double(i) / per_value;
    const glm::dvec3 color = function.color_at(value) * color_factor;
    for (int c = 0; c < 3; ++c) rows_.push_back(float(color[c]));
    const double extinction = function.extinction_at(value);
    extinctions_.push_back(float(extinction));
    opacities_.push_back(float(-std::expm1(-extinction * step_mm)));
    rows_.push_back(extinctions_.back());
  }
  colors_ = segments_of(function.color, value_bias, color_factor);
  first_value_ = float(domain.first - value_bias);
  rows_per_value_ = float(per_value);
}

TransferTable TransferRows::view() const {
  const std::size_t last_row = extinctions_.size() - 1;
  return {rows_.data(), extinctions_.data(), opacities_.data(), colors_,
          first_value_, rows_per_value_,     float(last_row)};
}

}  // namespace goldthread
