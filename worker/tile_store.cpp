// SPDX-License-Identifier: Apache-2.0
#include "worker/tile_store.h"

#include <utility>

namespace goldthread {

void TileStore::clear() {
  tiles_.clear();
  places_.clear();
  bytes_ = 0;
}

std::unique_ptr<TileRefinement> TileStore::take(TileId id) {
  const auto found = places_.find(id.value);
  if (found == places_.end()) return nullptr;
  auto tile = std::move(found->second->tile);
  bytes_ -= found->second->bytes;
  tiles_.erase(found->second);
  places_.erase(found);
  return tile;
}

void TileStore::put(TileId id, std::unique_ptr<TileRefinement> tile) {
  take(id);
  const std::size_t bytes = tile->bytes();
  tiles_.push_front({id, std::move(tile), bytes});
  places_[id.value] = tiles_.begin();
  bytes_ += bytes;
  while (bytes_ > most_bytes_ && tiles_.size() > 1) take(tiles_.back().id);
}

}  // namespace goldthread
