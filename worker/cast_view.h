// SPDX-License-Identifier: Apache-2.0
#pragma once
// A view that can be cast: immutable, shared by the threads that work on it.

#include <memory>

#include "common/tile/refinement.h"
#include "common/tile/tile_grid.h"
#include "worker/refinement/tile_plane.h"
#include "worker/sample_source.h"

namespace goldthread {

struct CastView {
  Epoch epoch;
  TileGrid grid;
  Refinement refinement;
  Appearance appearance;
  std::shared_ptr<const SampleSource> source;
};

}  // namespace goldthread
