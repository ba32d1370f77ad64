// SPDX-License-Identifier: Apache-2.0
#pragma once
// Who casts which tile next. All tiles take a step before any takes the next, so that what a
// picture holds after a step depends on nobody's speed. Within a step the order is: at the first
// step of a view descending predicted cost (longest first), after that descending (estimated error
// × area) / predicted cost. Tiles go to whoever has room; where several steps are foreseen, each
// worker is dealt tiles that will take as long in all as the others'. A tile stays with the worker
// that holds its state; a worker with nothing left takes over another's where that is quicker than
// waiting. Cheap tiles go out together, so that what a quantum costs beside its rays does not
// count. What a lost worker has done of the open step is done again: its samples may have gone with
// it. Pure: no clock, no transport. Invariant: each (tile, step) of a view is done for the first
// time once.

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

/// The order in which tiles go out; VOL2 compares the two.
enum class Order : std::uint8_t {
  kUrgent,  ///< descending predicted cost at the first step, then error per cost
  kScreen   ///< as they are numbered, from the top left; nothing is asked of costs
};
/// Who gets a tile.
enum class Share : std::uint8_t {
  kOnDemand,    ///< whoever has room
  kContiguous,  ///< each worker as many tiles, one after the other; no one takes over
  kInterleaved  ///< likewise, but worker w of n each n-th
};
/// Work that each of a worker's threads has in hand: what a question to the master and its answer
/// take where both poll with a back-off on busy cores, and a bit more.
constexpr double kSpareUs = 500;
/// Of tiles that take next to no time: what a worker may hold at most.
constexpr std::size_t kMostHeld = 64;
/// What benches compare.
struct Strategy {
  Order order = Order::kUrgent;
  Share share = Share::kOnDemand;
  /// For each of its threads a worker may hold more quanta than it has places while they are
  /// predicted to take less than this. Clusters take kSpareUs.
  double spare_us = 0;
};

/// Cheap tiles are joined until the quantum is predicted to take so long, or this share of what a
/// thread has to do in the step, whatever is less: then the last one to end is hardly late.
constexpr double kJoinedUs = 300;
constexpr double kJoinedShare = 1.0 / 64;
constexpr std::size_t kMostJoined = 16;
/// A spare is held back from a worker whose threads are busy once what waits beside it would keep
/// the threads that it waits for busy for less than this many times as long: at the end of a step
/// it would wait there while others are idle. What is no dearer than joined tiles never is, nor
/// what would take another worker more than this many times as long.
constexpr double kSpareRounds = 2;

class Scheduler {
 public:
  /// `capacity[w]`: how many quanta worker w may hold at once, its spare one included.
  explicit Scheduler(const std::vector<int>& capacity, Strategy strategy = {});

  /// Forgets the old view and everything in flight; the first step is open. `last`: the step up to
  /// which costs foresee the view to be refined, 1 of one that has no more or that nothing is known
  /// of.
  void begin_view(const TileGrid& grid, const CostHistory& costs, Step last = {1});
  /// Opens the next step; the one before must be finished.
  void open_step(const CostHistory& costs);
  /// Nothing of the view is given out any more.
  void cancel();

  /// The next quantum for `worker`, if it has room and there is work for it. One with fewer than it
  /// has threads always gets what is its own or nobody's.
  std::optional<Quantum> next(int worker);
  /// Directly after next(): another tile for the same quantum, while that remains small. It has its
  /// own done(); there is room for the next quantum when all of them are.
  std::optional<TileId> join(int worker);
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
  /// What a tile was predicted to take when the open step was queued, µs.
  double predicted_us(TileId tile) const { return tiles_[tile.value].cost_us; }

 private:
  /// Tiles that wait, the most urgent first, and what they are predicted to take.
  struct Queue {
    std::deque<TileId> tiles;
    double us = 0;
  };
  struct Worker {
    int capacity = 0;
    bool lost = false;
    std::vector<std::vector<TileId>> held;  ///< quanta, the newest last
    double newest_us = 0;                   ///< predicted of that one
    double held_us = 0;                     ///< of all, what nothing is known of as dear
    Queue waiting;                          ///< tiles whose state it holds, or that it was dealt
    int threads() const { return capacity > 1 ? capacity - 1 : 1; }
  };
  struct Tile {
    int owner = -1;      ///< worker that holds its state
    int done_by = -1;    ///< that did the open step
    bool again = false;  ///< the open step was done before, by a lost worker
    double squared_error = 0;
    double cost_us = 0;      ///< predicted, of the open step
    double all_cost_us = 0;  ///< of all steps up to this one, or the last foreseen: what a newcomer
                             ///< would spend
  };
  void deal_alike();
  void deal_by_cost(const CostHistory& costs);
  std::vector<int> alive() const;
  void count_threads();
  void queue(const CostHistory& costs);
  /// What waits for a worker, or of kNobody for whoever comes first.
  Queue& queue_of(int owner) {
    return owner < 0 ? unowned_ : workers_[static_cast<std::size_t>(owner)].waiting;
  }
  /// Where `worker` takes its next tile from.
  int source_for(int worker) const;
  void put(int owner, TileId tile);
  TileId take(int owner, const std::deque<TileId>::const_iterator& at);
  void note_waiting(int owner);
  bool is_due(const Worker& taker, TileId tile, double waiting_us, int threads) const;
  double expected_us(TileId tile) const;
  bool has_room(const Worker& worker) const;
  void hold(Worker& worker, TileId tile);
  std::optional<TileId> take(int worker);
  std::optional<TileId> take_over(int worker);
  double held_us(const Worker& worker) const;
  /// What `worker` has done of the open step, which is not done any more.
  std::vector<TileId> take_back(int worker);

  Strategy strategy_;
  std::vector<Worker> workers_;
  LargestOf longest_wait_{0};  ///< what waits for each worker / its threads, µs
  std::vector<Tile> tiles_;
  Queue unowned_;
  int threads_ = 1;       ///< of all workers that are not lost
  double joined_us_ = 0;  ///< that joined tiles may take
  Step step_ = kNoStep;
  Step last_{1};  ///< foreseen
  std::size_t open_ = 0;
};

}  // namespace goldthread
