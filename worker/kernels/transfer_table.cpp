// SPDX-License-Identifier: Apache-2.0
#include "worker/kernels/transfer_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace goldthread {
namespace {

constexpr double kLeastRows = 4096;
constexpr double kMostRows = 65536;
constexpr double kMostOpacity = 1 - 1e-6;
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
  // A row in front of the first node: where that is a step, another value holds before it.
  const double range = std::max(nodes.last - nodes.first, info.maximum - info.minimum);
  nodes.first -= info.type == VoxelType::kFloat32 ? range / kLeastRows : 1;
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

// Fits segments to a transfer function, splitting the intervals between its nodes until cubics
// hold.
class SegmentFit {
 public:
  SegmentFit(const TransferFunction& function, double value_bias, double color_factor,
             double step_mm)
      : function_(function), bias_(value_bias), factor_(color_factor), step_mm_(step_mm) {}

  TransferSegments run() {
    std::vector<double> nodes;
    for (const ColorNode& node : function_.color) nodes.push_back(node.value);
    for (const OpacityNode& node : function_.opacity) nodes.push_back(node.value);
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    // Before the first node all is constant: a segment of no width holds there.
    add_constant(nodes.front(), std::nextafter(nodes.front(), -kInfinity));
    for (std::size_t i = 1; i < nodes.size(); ++i) add(nodes[i - 1], nodes[i], kSplits);
    add_constant(nodes.back(), nodes.back());
    if (too_many_) segments_.count = 0;
    if (segments_.count > 0) add_buckets();
    return segments_;
  }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  static constexpr double kTolerance = 2e-7;  ///< relative to opacity
  static constexpr int kSplits = 5;

  struct Cubic {
    std::array<double, 4> c{};
    double operator()(double w) const { return c[0] + w * (c[1] + w * (c[2] + w * c[3])); }
  };

  // Opacity of the function is a line between two neighbouring nodes; here from the line, so that
  // the ends are those of this interval also where the function jumps.
  struct Line {
    double begin, slope;
    Line(const TransferFunction& function, double from, double width) {
      const double low = function.opacity_at(from + 0.25 * width);
      const double high = function.opacity_at(from + 0.75 * width);
      slope = (high - low) / (0.5 * width);
      begin = low - slope * 0.25 * width;
      if (std::abs(begin) < 1e-12) begin = 0;
    }
    double at(double w) const { return std::clamp(begin + slope * w, 0.0, kMostOpacity); }
  };

  double of_step(double opacity) const {
    return -std::expm1(std::log1p(-opacity) * step_mm_ / function_.unit_distance_mm);
  }

  void add(double from, double until, int splits) {
    const double width = until - from;
    const Line line(function_, from, width);
    const Cubic cubic = fit(line, width);
    if (!holds(cubic, line, width)) {
      if (splits == 0) {
        too_many_ = true;
      } else {
        const double middle = 0.5 * (from + until);
        add(from, middle, splits - 1);
        add(middle, until, splits - 1);
      }
      return;
    }
    const glm::dvec3 low = function_.color_at(from + 0.25 * width);
    const glm::dvec3 high = function_.color_at(from + 0.75 * width);
    const glm::dvec3 slope = (high - low) / (0.5 * width);
    append(from, low - slope * (0.25 * width), slope, cubic);
  }

  void add_constant(double from, double at) {
    const double opacity = std::min(function_.opacity_at(at), kMostOpacity);
    append(from, function_.color_at(at), glm::dvec3(0), {{of_step(opacity), 0, 0, 0}});
  }

  // Through four points, the ends among them: 0 stays 0.
  Cubic fit(const Line& line, double width) const {
    constexpr std::array<double, 4> kAt{0, 0.25, 0.75, 1};
    std::array<double, 4> divided{};
    for (std::size_t i = 0; i < 4; ++i) divided[i] = of_step(line.at(kAt[i] * width));
    for (std::size_t order = 1; order < 4; ++order)
      for (std::size_t i = 3; i >= order; --i)
        divided[i] = (divided[i] - divided[i - 1]) / ((kAt[i] - kAt[i - order]) * width);
    const double a = kAt[1] * width, b = kAt[2] * width;
    return {{divided[0], divided[1] - divided[2] * a + divided[3] * a * b,
             divided[2] - divided[3] * (a + b), divided[3]}};
  }

  bool holds(const Cubic& cubic, const Line& line, double width) const {
    // Beyond, its coefficients leave float; the rows serve there.
    if (!(width > 1e-9 && width < 1e9)) return false;
    constexpr int kProbes = 64;
    for (int i = 1; i < kProbes; ++i) {
      const double w = width * i / kProbes;
      const double wanted = of_step(line.at(w));
      if (!(std::abs(cubic(w) - wanted) <= kTolerance * wanted)) return false;
    }
    return true;
  }

  void append(double start, const glm::dvec3& color, const glm::dvec3& slope, const Cubic& cubic) {
    if (segments_.count == TransferSegments::kMost) {
      too_many_ = true;
      return;
    }
    const int i = segments_.count++;
    segments_.start[i] = float(start - bias_);
    for (int c = 0; c < 3; ++c) {
      segments_.color[c][0][i] = float(color[c] * factor_);
      segments_.color[c][1][i] = float(slope[c] * factor_);
    }
    for (std::size_t k = 0; k < 4; ++k) segments_.opacity[k][i] = float(cubic.c[k]);
  }

  // The kernel forms the same product: its rounding moves a start and a value alike. What lies
  // before the first start is in the first bucket, what lies behind the last one in the last.
  void add_buckets() {
    constexpr int kLastBucket = TransferSegments::kBuckets - 1;
    TransferSegments& s = segments_;
    const int last = s.count - 1;
    const float width = s.start[last] - s.start[0];
    if (!(width > 0)) return;
    s.buckets_per_value = float(kLastBucket - 1) / width;
    s.first_bucket = s.start[0] - 1 / s.buckets_per_value;
    std::array<int, TransferSegments::kBuckets> starts{};
    for (int i = 0; i <= last; ++i) {
      s.end[i] = i < last ? s.start[i + 1] : std::numeric_limits<float>::infinity();
      if (i == 0) continue;
      const float exact = (s.start[i] - s.first_bucket) * s.buckets_per_value;
      const int bucket = std::clamp(int(exact), 0, kLastBucket);
      ++starts[std::size_t(bucket)];
      for (int b = bucket + 1; b <= kLastBucket; ++b) s.bucket[b] = std::uint8_t(i);
    }
    s.has_buckets = *std::max_element(starts.begin(), starts.end()) <= 1;
  }

  const TransferFunction& function_;
  double bias_, factor_, step_mm_;
  TransferSegments segments_;
  bool too_many_ = false;
};

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
    // The last row is at the last node, not a rounding before it: what holds there holds behind.
    const double place = domain.first + double(i) / per_value;
    const double value = i + 1 == count ? std::max(place, domain.last) : place;
    const glm::dvec3 color = function.color_at(value) * color_factor;
    for (int c = 0; c < 3; ++c) rows_.push_back(float(color[c]));
    const double extinction = function.extinction_at(value);
    extinctions_.push_back(float(extinction));
    opacities_.push_back(float(-std::expm1(-extinction * step_mm)));
    rows_.push_back(extinctions_.back());
  }
  if (!function.opacity.empty())
    segments_ = SegmentFit(function, value_bias, color_factor, step_mm).run();
  first_value_ = float(domain.first - value_bias);
  rows_per_value_ = float(per_value);
}

TransferTable TransferRows::view() const {
  const std::size_t last_row = extinctions_.size() - 1;
  return {rows_.data(), extinctions_.data(), opacities_.data(), &segments_,
          first_value_, rows_per_value_,     float(last_row)};
}

}  // namespace goldthread
