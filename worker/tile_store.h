// SPDX-License-Identifier: Apache-2.0
#pragma once
// The tiles of one view that a worker can go on with. Those that were not used for longest are let
// go when they need too much memory: what is missing is cast again, with the same results.

#include <cstdint>
#include <list>
#include <memory>
#include <unordered_map>

#include "common/base/types.h"
#include "worker/refinement/tile_refinement.h"

namespace goldthread {

class TileStore {
 public:
  explicit TileStore(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  void clear();
  /// Takes a tile out; null if it is not there.
  std::unique_ptr<TileRefinement> take(TileId id);
  void put(TileId id, std::unique_ptr<TileRefinement> tile);
  std::size_t size() const { return tiles_.size(); }

 private:
  struct Held {
    TileId id;
    std::unique_ptr<TileRefinement> tile;
    std::size_t bytes = 0;
  };

  std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  std::list<Held> tiles_;  ///< the newest first
  std::unordered_map<std::uint32_t, std::list<Held>::iterator> places_;
};

}  // namespace goldthread
