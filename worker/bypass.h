// SPDX-License-Identifier: Apache-2.0
#pragma once
// By-passing a worker (State et al. 1995): each quantum is answered as if one ray had been cast for
// each pixel, with messages of the same number and size, and nothing is computed.

#include "worker/refine_tile.h"
#include "worker/worker_role.h"

namespace goldthread {

/// Makes no source of samples: nothing asks one.
std::shared_ptr<const SampleSource> no_source(const std::shared_ptr<const CommittedScene>& scene,
                                              const Camera& camera, ImageSize size);

/// Answers like refine_tile for Sampling::kEveryPixel, whatever the view's sampling: the same
/// places, all of them clear, and no error. What messages hold is made once for each size of tile.
TileCaster bypassed_tiles();

}  // namespace goldthread
