// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the real master and the real compositor compute for a tile, measured without a network: the
// cluster's own code with a transport whose peers answer at once, outside of the measured time.

#include <vector>

#include "bench/error/subject.h"
#include "bench/scale/cluster_model.h"

namespace goldthread::bench {

/// A master of that many workers, with four tiles for each (at least 256, at most 16384).
MasterCosts measure_master(const Subject& subject, int workers);

/// What it takes to decode the samples of a tile of 64×64 pixels and put them in their places.
struct PlacingCosts {
  Affine place;
  double residual = 0;
};
PlacingCosts measure_placing();

}  // namespace goldthread::bench
