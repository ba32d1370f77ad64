// SPDX-License-Identifier: Apache-2.0
#include "common/tile/fill_holes.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "common/base/lanes.h"
#include "common/tile/tile_grid.h"

namespace goldthread {
namespace {

/// What the place holds in the end. Without a branch: where half of the places are known, every
/// second one would be mispredicted, which costs several times as much.
Lanes put(Sample* place, std::uint8_t known, Lanes filling) {
  const std::int32_t all_bits = known ? -1 : 0;
  const Lanes lanes =
      LaneInts{all_bits, all_bits, all_bits, all_bits} ? load_lanes(place) : filling;
  store_lanes(place, lanes);
  return lanes;
}

struct MeanRule {
  static Lanes edge(Lanes a, Lanes b) { return (a + b) * 0.5f; }
  static Lanes centre(Lanes left, Lanes right, Lanes above, Lanes below) {
    return ((left + right) + (above + below)) * 0.25f;
  }
};

struct BoxRule {
  static Lanes edge(Lanes a, Lanes) { return a; }
  static Lanes centre(Lanes left, Lanes, Lanes, Lanes) { return left; }
};

template <typename Rule>
void fill_row(Sample* row, const std::uint8_t* known, int stride, int spacing) {
  const int half = spacing / 2;
  Lanes left = load_lanes(row);
  for (int x = half; x < stride; x += spacing) {
    const Lanes right = load_lanes(row + x + half);
    put(row + x, known[x], Rule::edge(left, right));
    left = right;
  }
}

/// The row between `above` and `below`: middles of vertical edges and centres.
template <typename Rule>
void fill_row_between(Sample* row, const std::uint8_t* known, const Sample* above,
                      const Sample* below, int stride, int spacing) {
  const int half = spacing / 2;
  Lanes left = put(row, known[0], Rule::edge(load_lanes(above), load_lanes(below)));
  for (int x = half; x < stride; x += spacing) {
    const int next = x + half;
    const Lanes right = put(row + next, known[next],
                            Rule::edge(load_lanes(above + next), load_lanes(below + next)));
    put(row + x, known[x], Rule::centre(left, right, load_lanes(above + x), load_lanes(below + x)));
    left = right;
  }
}

/// All squares of a spacing, a row of squares at a time so that it is still in the cache.
template <typename Rule>
void fill_squares(const TilePlane& plane, int spacing) {
  const std::ptrdiff_t down = std::ptrdiff_t(spacing) / 2 * plane.stride;
  Sample* above = plane.samples.data();
  const std::uint8_t* known = plane.known.data();
  fill_row<Rule>(above, known, plane.stride, spacing);
  for (int y = spacing; y < plane.rows; y += spacing) {
    Sample* below = above + 2 * down;
    fill_row<Rule>(below, known + 2 * down, plane.stride, spacing);
    fill_row_between<Rule>(above + down, known + down, above, below, plane.stride, spacing);
    above = below;
    known += 2 * down;
  }
}

/// A line of samples `2 * half` apart, seen from the place between two of them.
struct CubicLine {
  std::ptrdiff_t half;
  bool more_before;  ///< there is a second sample before the place
  bool more_after;

  Lanes at(const Sample* place) const {
    const Lanes a = load_lanes(place - half), b = load_lanes(place + half);
    if (more_before && more_after) {
      return ((a + b) * 9.0f - (load_lanes(place - 3 * half) + load_lanes(place + 3 * half))) *
             0.0625f;
    }
    if (more_before) return (a * 6.0f + b * 3.0f - load_lanes(place - 3 * half)) * 0.125f;
    if (more_after) return (b * 6.0f + a * 3.0f - load_lanes(place + 3 * half)) * 0.125f;
    return (a + b) * 0.5f;
  }
};

/// Cubics overshoot beside edges.
Lanes within_range(Lanes sample) {
  const Lanes nothing{0, 0, 0, 0};
  const Lanes positive = sample > nothing ? sample : nothing;
  return positive[3] > 1 ? Lanes{positive[0], positive[1], positive[2], 1} : positive;
}

class CubicFill {
 public:
  CubicFill(const TilePlane& plane, int spacing)
      : plane_(plane), spacing_(spacing), half_(spacing / 2) {}

  /// Centres need the edges' middles of the squares around, so these come first.
  void run() const {
    for_places(half_, 0, [this](const Sample* at, int x, int) { return row_at(x).at(at); });
    for_places(0, half_, [this](const Sample* at, int, int y) { return column_at(y).at(at); });
    for_places(half_, half_, [this](const Sample* at, int x, int y) {
      return (row_at(x).at(at) + column_at(y).at(at)) * 0.5f;
    });
  }

 private:
  CubicLine row_at(int x) const { return {half_, x >= 3 * half_, x + 3 * half_ < plane_.stride}; }
  CubicLine column_at(int y) const {
    return {std::ptrdiff_t(half_) * plane_.stride, y >= 3 * half_, y + 3 * half_ < plane_.rows};
  }
  template <typename Rule>
  void for_places(int first_x, int first_y, Rule rule) const {
    for (int y = first_y; y < plane_.rows; y += spacing_) {
      Sample* row = plane_.samples.data() + std::ptrdiff_t(y) * plane_.stride;
      const std::uint8_t* known = plane_.known.data() + std::ptrdiff_t(y) * plane_.stride;
      for (int x = first_x; x < plane_.stride; x += spacing_) {
        if (!known[x]) store_lanes(row + x, within_range(rule(row + x, x, y)));
      }
    }
  }

  const TilePlane& plane_;
  int spacing_;
  int half_;
};

/// Whether all that is known is one colour, as in a tile of background.
bool is_constant(const TilePlane& plane) {
  const Sample& first = plane.samples[0];
  const std::size_t count = plane.known.size();
  std::size_t i = 0;
  for (; i + sizeof(std::uint64_t) <= count; i += sizeof(std::uint64_t)) {
    std::uint64_t some;
    std::memcpy(&some, plane.known.data() + i, sizeof some);
    if (some == 0) continue;
    for (std::size_t j = i; j < i + sizeof some; ++j)
      if (plane.known[j] && plane.samples[j] != first) return false;
  }
  for (; i < count; ++i)
    if (plane.known[i] && plane.samples[i] != first) return false;
  return true;
}

}  // namespace

void fill_holes(const TilePlane& plane, Filter filter) {
  if (!plane.known[0] || !std::memchr(plane.known.data(), 0, plane.known.size())) return;
  if (is_constant(plane)) {
    std::fill(plane.samples.begin(), plane.samples.end(), Sample(plane.samples[0]));
    return;
  }
  for (int spacing = kCoarsestSpacing; spacing > 1; spacing /= 2) {
    if (filter == Filter::kBicubic) {
      CubicFill(plane, spacing).run();
    } else if (filter == Filter::kBox) {
      fill_squares<BoxRule>(plane, spacing);
    } else {
      fill_squares<MeanRule>(plane, spacing);
    }
  }
}

}  // namespace goldthread
