// SPDX-License-Identifier: Apache-2.0
#pragma once
// Rays where none are thought to be needed. Each step casts a few in every block of 16×16 pixels,
// at places that no ray has been through: what they bring, held against what was filled in there,
// measures the error of all that was filled in, whatever the scene; and a thing too thin for the
// coarse samples is met in the end, for the places go around all 256 of a block.

#include <cstdint>
#include <vector>

#include "worker/refinement/tile_lattice.h"

namespace goldthread {

/// Blocks of 16×16 pixels of a tile, row by row.
class Probes {
 public:
  /// `seed` tells tiles apart.
  void restart(ImageSize tile, std::uint32_t seed);

  /// Of the next `count` places of each block those that are not known. The known ones count too,
  /// as places without an error: to go on to others would favour the surroundings of what is known.
  std::vector<SampleOffset> next(const TileLattice& lattice, int count);
  /// `squared` is the squared error that was found at a place of the last next(). A surprise,
  /// beyond what the samples around let expect, is as rare as all probes of its block so far make
  /// it, and not only the last ones: what they had found would be sampled by now.
  void note(SampleOffset place, double squared, bool surprising);
  /// The sum over all pixels of the squared error of filling in, by what the last probes found.
  double squared_error(const TileLattice& lattice) const;

 private:
  struct Block {
    int x = 0, y = 0;
    std::uint32_t taken = 0;  ///< places of its order that were looked at
    std::uint32_t offset = 0;
    int looked = 0;  ///< at pixels by the last next()
    double mean_squared = 0;
  };

  int columns_ = 0;
  std::vector<Block> blocks_;
};

}  // namespace goldthread
