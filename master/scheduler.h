// SPDX-License-Identifier: Apache-2.0
#pragma once
// Who casts which tile next. Tiles of a level are handed out first come, first served, in
// descending order of their predicted cost (longest first), then those of the next level; each
// worker holds a spare one. Pure: no clock, no transport. Invariant: of a view, each (tile, level)
// is given out once, or again only when its worker was lost, and is counted as done once.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/tile/tile_grid.h"
#include "master/cost_history.h"

namespace goldthread {

/// A piece of work as the scheduler sees it.
struct Quantum {
  TileId tile;
  Level from;
  Level to;
  bool operator==(const Quantum&) const = default;
};

class Scheduler {
 public:
  /// `capacity[w]`: how many quanta worker w may hold at once, its spare one included.
  explicit Scheduler(const std::vector<int>& capacity);

  /// Forgets the old view and everything in flight. Levels run through `levels` (coarse to fine, at
  /// least one); the order within each follows `costs`.
  void begin_view(const TileGrid& grid, std::span<const Level> levels, const CostHistory& costs);
  /// The next quantum for `worker`, if it has room and there is work.
  std::optional<Quantum> next(int worker);
  /// `worker` has finished a quantum; anything it does not hold is ignored. True if it was held.
  bool done(int worker, TileId tile, Level to);
  /// What `worker` held is given out again, first of all and in the same order; it gets nothing
  /// any more.
  void worker_lost(int worker);

  /// Quanta of the view that are not done yet.
  std::size_t open() const { return open_; }
  /// Tiles of a level that are done.
  std::size_t done_at(Level level) const;
  bool finished() const { return open_ == 0; }

 private:
  struct Worker {
    int capacity = 0;
    std::vector<std::size_t> held;  // places in queue_
  };
  void append_level(const TileGrid& grid, Level from, Level to, const CostHistory& costs);

  std::vector<Worker> workers_;
  std::vector<Quantum> queue_;  // in order; those before next_ are given out
  std::size_t next_ = 0;
  std::vector<std::size_t> returned_;  // of lost workers, to be given out first, from the back
  std::size_t open_ = 0;
  std::vector<std::pair<Level, std::size_t>> done_;
};

}  // namespace goldthread
