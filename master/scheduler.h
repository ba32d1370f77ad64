// SPDX-License-Identifier: Apache-2.0
#pragma once
// Who casts which tile next. All tiles take a step before any takes the next, so that what a
// picture holds after a step depends on nobody's speed. Within a step the order is: at the first
// step of a view descending predicted cost (longest first), after that descending (estimated error
// × area) / predicted cost. A tile stays with the worker that holds its state; a worker with
// nothing left takes over another's where casting the earlier steps again is quicker than waiting.
// What a lost worker has done of the open step is done again: its samples may have gone with it.
// Pure: no clock, no transport. Invariant: each (tile, step) of a view is done for the first time
// once.

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/tile/tile_grid.h"
#include "master/cost_history.h"
#include "master/largest_of.h"

namespace goldthread {

/// A piece of work as the scheduler sees it.
struct Quantum {
  TileId tile;
  Step from;
  Step to;
  bool operator==(const Quantum&) const = default;
};

/// What became of a quantum that a worker says it has finished.
enum class Finished : std::uint8_t {
  kNot,    ///< the worker did not hold it
  kAgain,  ///< as it was before, by a worker that was lost since
  kFirst
};

class Scheduler {
 public:
  /// `capacity[w]`: how many quanta worker w may hold at once, its spare one included.
  explicit Scheduler(const std::vector<int>& capacity);

  /// Forgets the old view and everything in flight; the first step is open.
  void begin_view(const TileGrid& grid, const CostHistory& costs);
  /// Opens the next step; the one before must be finished.
  void open_step(const CostHistory& costs);
  /// Nothing of the view is given out any more.
  void cancel();

  /// The next quantum for `worker`, if it has room and there is work.
  std::optional<Quantum> next(int worker);
  /// `worker` has finished a quantum; anything it does not hold is ignored. `squared_error` is the
  /// tile's, summed over its pixels.
  Finished done(int worker, TileId tile, Step to, double squared_error);
  /// What `worker` held, and what it has done of a step that is still open, is given out again,
  /// first of all; it gets nothing any more.
  void worker_lost(int worker);

  /// The step that is open.
  Step step() const { return step_; }
  /// Its quanta that are not done yet.
  std::size_t open() const { return open_; }
  bool finished() const { return open_ == 0; }

 private:
  struct Worker {
    int capacity = 0;
    bool lost = false;
    std::vector<TileId> held;
    std::deque<TileId> waiting;  ///< those whose state it holds, the most urgent first
    double waiting_us = 0;
  };
  struct Tile {
    int owner = -1;      ///< worker that holds its state
    int done_by = -1;    ///< that did the open step
    bool again = false;  ///< the open step was done before, by a lost worker
    double squared_error = 0;
    double cost_us = 0;      ///< predicted, of the open step
    double all_cost_us = 0;  ///< of this and all earlier steps: what a newcomer would spend
  };
  void queue(const CostHistory& costs);
  std::optional<TileId> take(int worker);
  std::optional<TileId> take_over(int worker);
  /// `us` more, or less, wait for this worker.
  void add_waiting(std::size_t worker, double us);
  /// What `worker` has done of the open step, which is not done any more.
  std::vector<TileId> take_back(int worker);

  std::vector<Worker> workers_;
  LargestOf longest_wait_;  ///< waiting_us of each worker / its capacity
  std::vector<Tile> tiles_;
  std::deque<TileId> unowned_;  ///< in order
  Step step_ = kNoStep;
  std::size_t open_ = 0;
};

}  // namespace goldthread
