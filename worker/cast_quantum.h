// SPDX-License-Identifier: Apache-2.0
#pragma once
// One quantum of work: the new samples of a tile, cast in small batches so that it can be abandoned
// between any two of them.

#include <functional>
#include <optional>

#include "common/protocol/messages.h"
#include "worker/sample_source.h"

namespace goldthread {

/// Rays between two looks at whether the work is still wanted: some tens of packets, about a
/// millisecond.
constexpr std::size_t kBatchRaysOfQuantum = 512;

struct CastQuantum {
  Samples samples;  ///< ready to be sent
  CastCounts counts;
};

/// The samples that take the tile from one level to the next; nothing if `stale` became true.
std::optional<CastQuantum> cast_quantum(const SampleSource& source, const TileGrid& grid,
                                        const RenderTile& quantum,
                                        const std::function<bool()>& stale);

}  // namespace goldthread
