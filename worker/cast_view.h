// SPDX-License-Identifier: Apache-2.0
#pragma once
// A view that can be cast: immutable, shared by the threads that work on it.

#include <memory>

#include "common/tile/refinement.h"
#include "common/tile/tile_grid.h"
#include "worker/refinement/tile_lattice.h"
#include "worker/sample_source.h"

namespace goldthread {

struct CastView {
  Epoch epoch;
  TileGrid grid;
  Refinement refinement;
  Appearance appearance;
  std::shared_ptr<const SampleSource> source;
  Update update = Update::kAll;
  std::uint32_t part = 0;  ///< of the samples: what an update casts
};

}  // namespace goldthread
