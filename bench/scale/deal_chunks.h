// SPDX-License-Identifier: Apache-2.0
#pragma once
// How a master above others would deal a picture: chunks of tiles that follow each other, the
// dearest first, each to the master that has least to do so far (Graham's longest first). Pure.

#include <cstdint>
#include <vector>

#include "bench/scale/cost_record.h"

namespace goldthread::bench {

/// The tiles of each of `masters` parts, ascending. Costs are of all steps together.
std::vector<std::vector<std::uint32_t>> deal_chunks(const FrameWork& predicted, int masters,
                                                    int tiles_per_chunk);

}  // namespace goldthread::bench
