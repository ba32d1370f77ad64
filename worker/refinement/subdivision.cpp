// SPDX-License-Identifier: Apache-2.0
#include "worker/refinement/subdivision.h"

#include <algorithm>
#include <array>

namespace goldthread {
namespace {

struct Place {
  int x = 0;
  int y = 0;
};

/// An edge whose ends differ by less than this share of the threshold is not bent, whatever lies
/// beyond them: most squares are done with at a glance.
constexpr float kFlat = 0.125F;

struct Corner {
  Place place;
  ShownLanes color;
};

enum class EdgeState : std::uint8_t {
  kSame,
  kDiffers,  ///< and its middle is known or wanted
  kAsks      ///< for a sample in its middle
};

struct Edge {
  Place middle;
  EdgeState state = EdgeState::kSame;
};

/// Chooses in one square after the other.
class Chooser {
 public:
  Chooser(TileLattice& lattice, int spacing, const SubdivisionRule& rule,
          std::vector<SampleOffset>& wanted)
      : lattice_(lattice),
        spacing_(spacing),
        half_(spacing / 2),
        rule_(rule),
        flat_(kFlat * rule.difference),
        wanted_(wanted) {}

  void choose(Square square, bool surprising) {
    const int x = square.x, y = square.y, s = spacing_;
    if (is_whole(x, y)) return;
    const Corner a = corner(x, y), b = corner(x + s, y);
    const Corner c = corner(x, y + s), d = corner(x + s, y + s);
    const ShownLanes range = range_of(a, b, c, d);
    const bool surfaces_differ = met_different_surfaces(a, b, c, d);
    const bool differ_at_all = surfaces_differ || exceeds(range, rule_.difference);
    if (rule_.all_five && !differ_at_all && !surprising) return;
    if (!differ_at_all && !surprising && !exceeds(range, flat_) && !any_known(x, y)) return;
    const bool all = surprising || rule_.all_five;
    const std::array edges{look_along(a, b, {1, 0}, all), look_along(a, c, {0, 1}, all),
                           look_along(b, d, {0, 1}, all), look_along(c, d, {1, 0}, all)};
    const bool same = std::all_of(edges.begin(), edges.end(),
                                  [](const Edge& edge) { return edge.state == EdgeState::kSame; });
    if (same && !all && !differ_at_all) return;
    if (spacing_ == rule_.whole) return want_pixels_of(square);
    for (const Edge& edge : edges)
      if (edge.state == EdgeState::kAsks) want(edge.middle);
    want({x + half_, y + half_});
  }

 private:
  void want(Place at) {
    // The replicated column and row serve what lies between; at the pixels nothing does.
    if (half_ == 1 && !lattice_.is_pixel(at.x, at.y)) return;
    if (!lattice_.mark_wanted(at.x, at.y)) return;
    wanted_.push_back({static_cast<std::uint16_t>(at.x), static_cast<std::uint16_t>(at.y)});
  }

  void want_pixels_of(Square square) {
    for (int y = square.y; y < square.y + spacing_; ++y)
      for (int x = square.x; x < square.x + spacing_; ++x)
        if (lattice_.is_pixel(x, y)) want({x, y});
  }

  Corner corner(int x, int y) { return {{x, y}, lattice_.at(x, y)}; }

  /// Of the five places inside the square.
  bool is_whole(int x, int y) const {
    return lattice_.known(x + half_, y + half_) && lattice_.known(x + half_, y) &&
           lattice_.known(x, y + half_) && lattice_.known(x + spacing_, y + half_) &&
           lattice_.known(x + half_, y + spacing_);
  }
  bool any_known(int x, int y) const {
    return lattice_.known(x + half_, y + half_) || lattice_.known(x + half_, y) ||
           lattice_.known(x, y + half_) || lattice_.known(x + spacing_, y + half_) ||
           lattice_.known(x + half_, y + spacing_);
  }

  bool met_different_surfaces(const Corner& a, const Corner& b) {
    return lattice_.with_surfaces() &&
           lattice_.surfaces_at(a.place.x, a.place.y) != lattice_.surfaces_at(b.place.x, b.place.y);
  }
  bool met_different_surfaces(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
    return met_different_surfaces(a, b) || met_different_surfaces(a, c) ||
           met_different_surfaces(a, d);
  }

  bool differ(const Corner& a, const Corner& b) {
    return exceeds(distance(a.color, b.color), rule_.difference) || met_different_surfaces(a, b);
  }

  static ShownLanes range_of(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
    return greater_of(greater_of(a.color, b.color), greater_of(c.color, d.color)) -
           lesser_of(lesser_of(a.color, b.color), lesser_of(c.color, d.color));
  }

  /// Whether the samples of an edge differ, its middle among them; it asks for a middle if its
  /// ends do.
  Edge look_along(const Corner& a, const Corner& b, Place step, bool forced) {
    const Place middle{a.place.x + half_ * step.x, a.place.y + half_ * step.y};
    if (lattice_.wanted(middle.x, middle.y)) return {middle, EdgeState::kDiffers};
    if (lattice_.known(middle.x, middle.y)) {
      const Corner m = corner(middle.x, middle.y);
      return {middle, differ(a, m) || differ(m, b) ? EdgeState::kDiffers : EdgeState::kSame};
    }
    // A middle that is filled was looked at from the square beyond.
    if (!forced && lattice_.filled(middle.x, middle.y)) return {middle, EdgeState::kSame};
    if (forced || differ(a, b) || is_bent(a, b, step)) return {middle, EdgeState::kAsks};
    lattice_.at(middle.x, middle.y);
    return {middle, EdgeState::kSame};
  }

  bool is_bent(const Corner& a, const Corner& b, Place step) {
    const Place before{a.place.x - spacing_ * step.x, a.place.y - spacing_ * step.y};
    const Place after{b.place.x + spacing_ * step.x, b.place.y + spacing_ * step.y};
    const ShownLanes way = b.color - a.color;
    if (!exceeds(distance(a.color, b.color), flat_)) return false;
    // Where the tile ends the line goes on straight.
    const ShownLanes in =
        lattice_.contains(before.x, before.y) ? a.color - lattice_.at(before.x, before.y) : way;
    const ShownLanes out =
        lattice_.contains(after.x, after.y) ? lattice_.at(after.x, after.y) - b.color : way;
    return exceeds(distance(in, out), rule_.bend);
  }

  TileLattice& lattice_;
  int spacing_;
  int half_;
  const SubdivisionRule& rule_;
  float flat_;
  std::vector<SampleOffset>& wanted_;
};

bool holds(Square square, int spacing, SampleOffset place) {
  return place.x >= square.x && place.x <= square.x + spacing && place.y >= square.y &&
         place.y <= square.y + spacing;
}

}  // namespace

std::vector<Square> squares_of(const TileLattice& lattice, int spacing) {
  std::vector<Square> squares;
  const int block = 4 * spacing;
  for (int block_y = 0; block_y < lattice.tile().height; block_y += block)
    for (int block_x = 0; block_x < lattice.tile().width; block_x += block)
      for (int y = block_y; y < std::min(block_y + block, lattice.tile().height); y += spacing)
        for (int x = block_x; x < std::min(block_x + block, lattice.tile().width); x += spacing)
          squares.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)});
  return squares;
}

void choose(TileLattice& lattice, std::span<const Square> squares, int spacing,
            const SubdivisionRule& rule, std::span<const SampleOffset> surprises,
            std::vector<SampleOffset>& wanted) {
  Chooser chooser(lattice, spacing, rule, wanted);
  for (const Square square : squares) {
    const bool surprising =
        std::any_of(surprises.begin(), surprises.end(),
                    [&](SampleOffset place) { return holds(square, spacing, place); });
    chooser.choose(square, surprising);
  }
}

std::vector<Square> quarters(const TileLattice& lattice, std::span<const Square> squares,
                             int spacing) {
  const int half = spacing / 2;
  std::vector<Square> result;
  for (const Square square : squares) {
    const int x = square.x, y = square.y;
    if (!lattice.known(x + half, y + half) && !lattice.known(x + half, y) &&
        !lattice.known(x, y + half) && !lattice.known(x + spacing, y + half) &&
        !lattice.known(x + half, y + spacing))
      continue;
    for (const int dy : {0, half})
      for (const int dx : {0, half})
        if (lattice.is_pixel(x + dx, y + dy))
          result.push_back(
              {static_cast<std::uint16_t>(x + dx), static_cast<std::uint16_t>(y + dy)});
  }
  return result;
}

std::vector<Square> with_next(const TileLattice& lattice, std::span<const Square> squares,
                              int spacing) {
  const int columns = lattice.columns() / spacing + 1, rows = lattice.rows() / spacing + 1;
  std::vector<bool> there(static_cast<std::size_t>(columns * rows));
  std::vector<Square> result;
  const auto add = [&](int x, int y) {
    const auto at = static_cast<std::size_t>(y / spacing * columns + x / spacing);
    if (!lattice.is_pixel(x, y) || there[at]) return;
    there[at] = true;
    result.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)});
  };
  for (const Square square : squares) {
    add(square.x, square.y);
    add(square.x + spacing, square.y);
    add(square.x, square.y + spacing);
  }
  return result;
}

}  // namespace goldthread
