// SPDX-License-Identifier: Apache-2.0
#pragma once
// One quantum of work: a tile taken through steps of refinement, its rays cast in small batches so
// that it can be abandoned between any two of them.

#include <functional>
#include <memory>
#include <optional>

#include "common/protocol/messages.h"
#include "worker/cast_view.h"
#include "worker/refinement/tile_refinement.h"

namespace goldthread {

struct RefinedTile {
  Samples samples;    ///< what the quantum changed, ready to be sent
  CastCounts counts;  ///< of the quantum's own steps
  TileQuality quality;
  std::unique_ptr<TileRefinement> tile;  ///< to go on with; null if there is nothing to keep
};

/// Takes a tile to quantum.to. `tile` is what this worker holds of it, or null: then, and if it
/// does not stand at quantum.from, its steps are taken again from the first, with the same results.
/// Nothing if `stale` became true.
std::optional<RefinedTile> refine_tile(const CastView& view, const RenderTile& quantum,
                                       std::unique_ptr<TileRefinement> tile,
                                       const std::function<bool()>& stale);

/// What a worker computes of a quantum: refine_tile, or the stub that by-passes it (bypass.h).
/// Asked by all threads of a worker at once.
using TileCaster = std::function<std::optional<RefinedTile>(
    const CastView& view, const RenderTile& quantum, std::unique_ptr<TileRefinement> tile,
    const std::function<bool()>& stale)>;

}  // namespace goldthread
