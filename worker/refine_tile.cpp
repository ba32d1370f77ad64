// SPDX-License-Identifier: Apache-2.0
#include "worker/refine_tile.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "common/tile/update_pattern.h"

namespace goldthread {
namespace {

TileTask task_of(const CastView& view, TileId tile) {
  return {view.grid.rect(tile), view.refinement, view.appearance, view.source->has_surfaces()};
}

/// Colours, then places, packed, with what the tile holds there now.
Samples pack(const TileRefinement& tile, const RenderTile& quantum,
             std::span<const SampleOffset> places) {
  Samples message{quantum.epoch,
                  quantum.tile,
                  quantum.from,
                  quantum.to,
                  static_cast<std::uint32_t>(places.size()),
                  Buffer(places.size() * (sizeof(Sample) + sizeof(SampleOffset)))};
  std::byte* const colors = message.packed.data();
  for (std::size_t i = 0; i < places.size(); ++i)
    std::memcpy(colors + i * sizeof(Sample), &tile.sample(places[i]), sizeof(Sample));
  if (!places.empty())
    std::memcpy(colors + places.size() * sizeof(Sample), places.data(),
                places.size() * sizeof(SampleOffset));
  return message;
}

/// A view that is updated in parts has one step: the part's samples.
bool cast_part(const CastView& view, const RenderTile& quantum, const TileRefinement::Cast& cast,
               Samples& message) {
  std::vector<PixelPosition> positions;
  for (const UpdatePlace& place : places_of(view.grid.rect(quantum.tile), view.update, view.part))
    positions.push_back(place.position);
  message = {quantum.epoch,
             quantum.tile,
             quantum.from,
             quantum.to,
             static_cast<std::uint32_t>(positions.size()),
             Buffer(positions.size() * sizeof(Sample))};
  std::vector<std::uint32_t> surfaces(positions.size());
  const std::span samples(reinterpret_cast<Sample*>(message.packed.data()), positions.size());
  return cast(positions, samples, surfaces);
}

}  // namespace

std::optional<RefinedTile> refine_tile(const CastView& view, const RenderTile& quantum,
                                       std::unique_ptr<TileRefinement> tile,
                                       const std::function<bool()>& stale) {
  RefinedTile result;
  const auto cast = [&](std::span<const PixelPosition> positions, std::span<Sample> samples,
                        std::span<std::uint32_t> surfaces) {
    const std::size_t batch = view.source->batch_rays();
    for (std::size_t first = 0; first < positions.size(); first += batch) {
      if (stale()) return false;
      const std::size_t count = std::min(batch, positions.size() - first);
      result.counts +=
          view.source->cast(positions.subspan(first, count), samples.subspan(first, count),
                            surfaces.subspan(first, count));
    }
    return true;
  };
  if (view.update != Update::kAll) {
    if (!cast_part(view, quantum, cast, result.samples)) return {};
    result.tile = std::move(tile);
    return result;
  }
  if (!tile)
    tile = std::make_unique<TileRefinement>(task_of(view, quantum.tile));
  else if (tile->step() != quantum.from)
    tile->restart(task_of(view, quantum.tile));
  std::vector<SampleOffset> changed;
  while (tile->step() < quantum.to) {
    if (!tile->advance(cast)) return {};
    // What was cast again is counted once: rays are those of the picture, whoever cast it.
    if (tile->step() <= quantum.from) result.counts = {};
    if (tile->step() > quantum.from)
      changed.insert(changed.end(), tile->changed().begin(), tile->changed().end());
  }
  result.samples = pack(*tile, quantum, changed);
  result.quality = tile->quality();
  result.tile = std::move(tile);
  return result;
}

}  // namespace goldthread
