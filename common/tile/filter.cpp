// SPDX-License-Identifier: Apache-2.0
#include "common/tile/filter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "common/base/lanes.h"

namespace goldthread {
namespace {

double box(double t) { return -0.5 <= t && t < 0.5 ? 1 : 0; }

double bilinear(double t) { return std::max(0.0, 1 - std::abs(t)); }

double biquadratic(double t) {
  const double a = std::abs(t);
  if (a <= 0.5) return 0.75 - a * a;
  return a < 1.5 ? 0.5 * (1.5 - a) * (1.5 - a) : 0;
}

double piecewise_quadratic(double t) {
  const double a = std::abs(t);
  if (a <= 0.5) return 1 - 2 * a * a;
  return a < 1.5 ? (a - 2.5) * a + 1.5 : 0;
}

double bicubic(double t) {
  const double a = std::abs(t);
  if (a <= 1) return (1.5 * a - 2.5) * a * a + 1;
  return a < 2 ? ((-0.5 * a + 2.5) * a - 4) * a + 2 : 0;
}

/// Along one axis: which source pixels make up each target pixel, and with what weights.
struct Taps {
  struct Range {
    int first = 0;           ///< source pixel
    std::size_t weight = 0;  ///< index of its weight
    int count = 0;
  };
  std::vector<Range> ranges;
  std::vector<float> weights;
};

struct Axis {
  int from = 1;      ///< source pixels
  double first = 0;  ///< the window
  double length = 1;
  int to = 1;  ///< target pixels
  double scale() const { return length / to; }
};

/// Of source pixel i, for a target pixel whose centre is at `centre` in source pixels.
double tap_weight(const Axis& axis, Filter filter, double centre, int i) {
  const double scale = axis.scale();
  if (filter == Filter::kBox && scale > 1) {
    const double covered =
        std::min(centre + scale / 2, i + 1.0) - std::max(centre - scale / 2, double(i));
    return std::max(0.0, covered);
  }
  return weight(filter, (i + 0.5 - centre) / std::max(1.0, scale));
}

/// Adds the taps of one target pixel; `by_source` is scratch memory.
void add_taps(const Axis& axis, Filter filter, int target, std::vector<double>& by_source,
              Taps& taps) {
  const double centre = axis.first + (target + 0.5) * axis.scale();
  // Half a pixel more than the kernel, for source pixels that a box covers in part.
  const double reach = support(filter) * std::max(1.0, axis.scale()) + 0.5;
  const int low = static_cast<int>(std::floor(centre - reach));
  const int high = static_cast<int>(std::floor(centre + reach));
  const int first = std::clamp(low, 0, axis.from - 1);
  by_source.assign(static_cast<std::size_t>(std::clamp(high, 0, axis.from - 1) - first + 1), 0);
  double sum = 0;
  for (int i = low; i <= high; ++i) {
    const double w = tap_weight(axis, filter, centre, i);
    by_source[static_cast<std::size_t>(std::clamp(i, 0, axis.from - 1) - first)] += w;
    sum += w;
  }
  const auto is_used = [](double w) { return w != 0; };
  const auto begin = std::find_if(by_source.begin(), by_source.end(), is_used);
  const auto end = std::find_if(by_source.rbegin(), by_source.rend(), is_used).base();
  taps.ranges.push_back({first + static_cast<int>(begin - by_source.begin()), taps.weights.size(),
                         static_cast<int>(end - begin)});
  for (auto w = begin; w != end; ++w) taps.weights.push_back(static_cast<float>(*w / sum));
}

/// The source pixels [first, end) that have any weight.
std::pair<int, int> needed(const Taps& taps) {
  int first = taps.ranges.front().first, end = 0;
  for (const Taps::Range& range : taps.ranges) {
    first = std::min(first, range.first);
    end = std::max(end, range.first + range.count);
  }
  return {first, end};
}

Taps taps_of(const Axis& axis, Filter filter) {
  Taps taps;
  std::vector<double> scratch;
  for (int target = 0; target < axis.to; ++target) add_taps(axis, filter, target, scratch, taps);
  return taps;
}

void filter_row(const float* source, const Taps& taps, float* target) {
  for (const Taps::Range& range : taps.ranges) {
    Lanes sum{};
    for (int i = 0; i < range.count; ++i) {
      const Lanes pixel = load_lanes(source + 4 * (range.first + i));
      sum += pixel * taps.weights[range.weight + static_cast<std::size_t>(i)];
    }
    store_lanes(target, sum);
    target += 4;
  }
}

void add_row(const float* source, float weight, std::size_t floats, float* target) {
  for (std::size_t i = 0; i < floats; ++i) target[i] += weight * source[i];
}

void keep_in_range(std::vector<float>& rgba) {
  for (float& value : rgba) value = std::max(value, 0.0f);
  for (std::size_t i = 3; i < rgba.size(); i += 4) rgba[i] = std::min(rgba[i], 1.0f);
}

bool overshoots(Filter filter) {
  return filter == Filter::kPiecewiseQuadratic || filter == Filter::kBicubic;
}

bool is_identity(ImageSize from, const SourceWindow& window, ImageSize to, Filter filter) {
  return filter != Filter::kBiquadratic && from == to && window.x == 0 && window.y == 0 &&
         window.width == from.width && window.height == from.height;
}

}  // namespace

double weight(Filter filter, double t) {
  switch (filter) {
    case Filter::kBox:
      return box(t);
    case Filter::kBilinear:
      return bilinear(t);
    case Filter::kBiquadratic:
      return biquadratic(t);
    case Filter::kPiecewiseQuadratic:
      return piecewise_quadratic(t);
    case Filter::kBicubic:
      return bicubic(t);
  }
  return 0;
}

double support(Filter filter) {
  switch (filter) {
    case Filter::kBox:
      return 0.5;
    case Filter::kBilinear:
      return 1;
    case Filter::kBiquadratic:
    case Filter::kPiecewiseQuadratic:
      return 1.5;
    case Filter::kBicubic:
      return 2;
  }
  return 0;
}

std::vector<float> resample(std::span<const float> rgba, ImageSize from, const SourceWindow& window,
                            ImageSize to, Filter filter) {
  if (is_identity(from, window, to, filter)) return {rgba.begin(), rgba.end()};
  const Taps across = taps_of({from.width, window.x, window.width, to.width}, filter);
  const Taps down = taps_of({from.height, window.y, window.height, to.height}, filter);
  const auto from_row = 4 * static_cast<std::size_t>(from.width);
  const auto to_row = 4 * static_cast<std::size_t>(to.width);
  const auto [first, end] = needed(down);
  std::vector<float> narrowed(static_cast<std::size_t>(end - first) * to_row);
  for (int y = first; y < end; ++y) {
    filter_row(rgba.data() + static_cast<std::size_t>(y) * from_row, across,
               narrowed.data() + static_cast<std::size_t>(y - first) * to_row);
  }
  std::vector<float> result(static_cast<std::size_t>(to.height) * to_row);
  for (std::size_t y = 0; y < down.ranges.size(); ++y) {
    const Taps::Range& range = down.ranges[y];
    for (int i = 0; i < range.count; ++i) {
      add_row(narrowed.data() + static_cast<std::size_t>(range.first - first + i) * to_row,
              down.weights[range.weight + static_cast<std::size_t>(i)], to_row,
              result.data() + y * to_row);
    }
  }
  if (overshoots(filter)) keep_in_range(result);
  return result;
}

}  // namespace goldthread
