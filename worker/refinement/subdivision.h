// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which samples a level of refinement adds above the pixel. Partial subdivision (State et al. 1995,
// VOL2): a sample between two neighbours only if those two differ, and the centre of a square only
// if any of its samples differ. Conventional subdivision: all five of a square whose corners
// differ. Two rays that met different surfaces differ whatever their colours. Pure: what is chosen
// depends on the lattice and the rule alone; along an edge that two tiles share both choose the
// same.

#include <span>
#include <vector>

#include "worker/refinement/tile_lattice.h"

namespace goldthread {

struct SubdivisionRule {
  float difference = 0;  ///< of a channel, displayed, in 0 … 1: two samples differ beyond it
  /// Beyond this an edge is too bent for a straight line: twice the second difference of the four
  /// samples around its middle is eight times what a cubic through them would change there.
  float bend = 1e9F;
  bool all_five = false;  ///< conventional subdivision
  int whole = 0;  ///< squares of this spacing get all of their pixels, if any; 0: no spacing
};

/// The upper left corner of a square of some spacing.
struct Square {
  std::uint16_t x = 0;
  std::uint16_t y = 0;
};

/// All squares of a spacing that hold a pixel, in Z-order of their blocks.
std::vector<Square> squares_of(const TileLattice& lattice, int spacing);

/// Appends the places wanted in `squares` to `wanted`, each once, and marks them in the lattice,
/// which must be given their samples before it is asked for anything finer. A square that holds one
/// of `surprises` is subdivided whatever the rule says.
void choose(TileLattice& lattice, std::span<const Square> squares, int spacing,
            const SubdivisionRule& rule, std::span<const SampleOffset> surprises,
            std::vector<SampleOffset>& wanted);

/// The quarters of those squares in which something is known beyond their corners.
std::vector<Square> quarters(const TileLattice& lattice, std::span<const Square> squares,
                             int spacing);

/// Those and the ones to their right and below, each once. A pixel lies in the square whose upper
/// left corner it is or that it is inside of, but an edge just left of it or above runs through
/// others.
std::vector<Square> with_next(const TileLattice& lattice, std::span<const Square> squares,
                              int spacing);

}  // namespace goldthread
