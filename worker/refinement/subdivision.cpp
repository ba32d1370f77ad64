// SPDX-License-Identifier: Apache-2.0
#include "worker/refinement/subdivision.h"

#include <algorithm>

namespace goldthread {
namespace {

struct Place {
  int x = 0;
  int y = 0;
};

/// Chooses in one square after the other.
class Chooser {
 public:
  Chooser(TilePlane& plane, int spacing, const SubdivisionRule& rule,
          std::vector<SampleOffset>& wanted)
      : plane_(plane), spacing_(spacing), half_(spacing / 2), rule_(rule), wanted_(wanted) {}

  void choose(Square square, bool surprising) {
    const int x = square.x, y = square.y;
    const bool all = surprising || (rule_.all_five && corners_differ(x, y));
    bool any = all || (!rule_.all_five && corners_differ(x, y));
    if (all || !rule_.all_five) {
      any |= edge({x, y}, {1, 0}, all);
      any |= edge({x, y}, {0, 1}, all);
      any |= edge({x + spacing_, y}, {0, 1}, all);
      any |= edge({x, y + spacing_}, {1, 0}, all);
    }
    if (any) want({x + half_, y + half_});
  }

 private:
  void want(Place at) {
    // The replicated column and row serve what lies between; at the pixels nothing does.
    if (half_ == 1 && !plane_.is_pixel(at.x, at.y)) return;
    if (!plane_.mark_wanted(at.x, at.y)) return;
    wanted_.push_back({static_cast<std::uint16_t>(at.x), static_cast<std::uint16_t>(at.y)});
  }

  bool differ(Place a, Place b) {
    if (plane_.with_surfaces() && plane_.surfaces_at(a.x, a.y) != plane_.surfaces_at(b.x, b.y))
      return true;
    return distance(plane_.at(a.x, a.y), plane_.at(b.x, b.y)) > rule_.difference;
  }

  bool corners_differ(int x, int y) {
    const int s = spacing_;
    return differ({x, y}, {x + s, y + s}) || differ({x + s, y}, {x, y + s}) ||
           differ({x, y}, {x + s, y}) || differ({x, y}, {x, y + s}) ||
           differ({x + s, y}, {x + s, y + s}) || differ({x, y + s}, {x + s, y + s});
  }

  /// Whether the samples of an edge differ, its middle among them; it is wanted if its ends do.
  bool edge(Place a, Place step, bool forced) {
    const Place b{a.x + spacing_ * step.x, a.y + spacing_ * step.y};
    const Place middle{a.x + half_ * step.x, a.y + half_ * step.y};
    if (plane_.wanted(middle.x, middle.y)) return true;
    if (plane_.known(middle.x, middle.y)) return differ(a, middle) || differ(middle, b);
    if (!forced && !differ(a, b) && !is_bent(a, b, step)) return false;
    want(middle);
    return true;
  }

  bool is_bent(Place a, Place b, Place step) {
    const Shown &p = plane_.at(a.x, a.y), &q = plane_.at(b.x, b.y);
    const Place before{a.x - spacing_ * step.x, a.y - spacing_ * step.y};
    const Place after{b.x + spacing_ * step.x, b.y + spacing_ * step.y};
    const bool has_before = plane_.contains(before.x, before.y);
    const bool has_after = plane_.contains(after.x, after.y);
    const Shown& o = has_before ? plane_.at(before.x, before.y) : p;
    const Shown& r = has_after ? plane_.at(after.x, after.y) : q;
    float most = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const float way = q.value[c] - p.value[c];
      // Where the tile ends the line goes on straight.
      const float in = has_before ? p.value[c] - o.value[c] : way;
      const float out = has_after ? r.value[c] - q.value[c] : way;
      most = std::max(most, std::abs(in - out));
    }
    return most > rule_.bend;
  }

  TilePlane& plane_;
  int spacing_;
  int half_;
  const SubdivisionRule& rule_;
  std::vector<SampleOffset>& wanted_;
};

bool holds(Square square, int spacing, SampleOffset place) {
  return place.x >= square.x && place.x <= square.x + spacing && place.y >= square.y &&
         place.y <= square.y + spacing;
}

}  // namespace

std::vector<Square> squares_of(const TilePlane& plane, int spacing) {
  std::vector<Square> squares;
  const int block = 4 * spacing;
  for (int block_y = 0; block_y < plane.tile().height; block_y += block)
    for (int block_x = 0; block_x < plane.tile().width; block_x += block)
      for (int y = block_y; y < std::min(block_y + block, plane.tile().height); y += spacing)
        for (int x = block_x; x < std::min(block_x + block, plane.tile().width); x += spacing)
          squares.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)});
  return squares;
}

void choose(TilePlane& plane, std::span<const Square> squares, int spacing,
            const SubdivisionRule& rule, std::span<const SampleOffset> surprises,
            std::vector<SampleOffset>& wanted) {
  Chooser chooser(plane, spacing, rule, wanted);
  for (const Square square : squares) {
    const bool surprising =
        std::any_of(surprises.begin(), surprises.end(),
                    [&](SampleOffset place) { return holds(square, spacing, place); });
    chooser.choose(square, surprising);
  }
}

std::vector<Square> quarters(const TilePlane& plane, std::span<const Square> squares,
                             int spacing) {
  const int half = spacing / 2;
  std::vector<Square> result;
  for (const Square square : squares) {
    const int x = square.x, y = square.y;
    if (!plane.known(x + half, y + half) && !plane.known(x + half, y) && !plane.known(x, y + half) &&
        !plane.known(x + spacing, y + half) && !plane.known(x + half, y + spacing))
      continue;
    for (const int dy : {0, half})
      for (const int dx : {0, half})
        if (plane.is_pixel(x + dx, y + dy))
          result.push_back({static_cast<std::uint16_t>(x + dx), static_cast<std::uint16_t>(y + dy)});
  }
  return result;
}

}  // namespace goldthread
