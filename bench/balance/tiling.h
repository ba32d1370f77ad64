// SPDX-License-Identifier: Apache-2.0
#pragma once
// The ways to hand a picture out that the bench compares.

#include <string>
#include <vector>

#include "master/cluster.h"
#include "master/tile_cut.h"

namespace goldthread::bench {

/// How the screen is cut.
enum class Tiling : std::uint8_t {
  kRows,       ///< VOL2's sample rows
  kSquares64,  ///< about 64 squares
  kSquares256,
  kOwn  ///< as a session in motion cuts: by the threads, dear tiles split
};
/// For so many threads.
ViewCut cut_of(Tiling tiling, ImageSize image, int threads);

struct Method {
  std::string name;
  Tiling tiling = Tiling::kOwn;
  Strategy strategy;
};
/// From the simplest to what sessions do.
std::vector<Method> all_methods();

}  // namespace goldthread::bench
