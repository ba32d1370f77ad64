// SPDX-License-Identifier: Apache-2.0
#include "master/scheduler.h"

#include <algorithm>
#include <utility>

namespace goldthread {

namespace {

/// Of tiles that take next to no time: what a worker's queue may grow to.
constexpr std::size_t kMostHeld = 64;

}  // namespace

Scheduler::Scheduler(const std::vector<int>& capacity, TileOrder order, double spare_us)
    : order_(std::move(order)), spare_us_(spare_us) {
  for (const int places : capacity) {
    Worker worker;
    worker.capacity = places;
    workers_.push_back(std::move(worker));
  }
}

void Scheduler::begin_view(const TileGrid& grid, const CostHistory& costs) {
  for (Worker& worker : workers_) {
    worker.held.clear();
    worker.held_us = 0;
  }
  tiles_.assign(grid.count(), {});
  squared_errors_.assign(grid.count(), 0);
  step_ = Step{1};
  queue(costs);
}

void Scheduler::open_step(const CostHistory& costs) {
  step_ = step_.next();
  queue(costs);
}

void Scheduler::cancel() {
  for (Worker& worker : workers_) {
    worker.held.clear();
    worker.held_us = 0;
    worker.waiting.clear();
  }
  unowned_.clear();
  open_ = 0;
}

void Scheduler::queue(const CostHistory& costs) {
  for (Worker& worker : workers_) {
    worker.waiting.clear();
    worker.waiting_us = 0;
  }
  unowned_.clear();
  for (const TileTurn& turn : order_(step_, squared_errors_, costs)) {
    Tile& tile = tiles_[turn.tile.value];
    tile.done_by = -1;
    tile.again = false;
    tile.cost_us = turn.cost_us;
    tile.all_cost_us = turn.all_cost_us;
    const int worker = tile.owner >= 0 ? tile.owner : turn.worker;
    if (worker < 0 || workers_[static_cast<std::size_t>(worker)].lost) {
      unowned_.push_back(turn.tile);
      continue;
    }
    Worker& owner = workers_[static_cast<std::size_t>(worker)];
    owner.waiting.push_back(turn.tile);
    owner.waiting_us += tile.cost_us;
  }
  open_ = tiles_.size();
}

std::optional<TileId> Scheduler::take(int worker) {
  Worker& own = workers_[static_cast<std::size_t>(worker)];
  if (!own.waiting.empty()) {
    const TileId tile = own.waiting.front();
    own.waiting.pop_front();
    own.waiting_us -= tiles_[tile.value].cost_us;
    return tile;
  }
  if (unowned_.empty()) return take_over(worker);
  const TileId tile = unowned_.front();
  unowned_.pop_front();
  return tile;
}

std::optional<TileId> Scheduler::take_over(int worker) {
  const auto busiest =
      std::max_element(workers_.begin(), workers_.end(), [](const Worker& a, const Worker& b) {
        return a.waiting_us / std::max(1, a.capacity) < b.waiting_us / std::max(1, b.capacity);
      });
  if (busiest->waiting.empty() || std::cmp_equal(busiest - workers_.begin(), worker)) return {};
  // The last one waits longest: until its owner has come through all before it.
  const TileId tile = busiest->waiting.back();
  const double wait_us = busiest->waiting_us / std::max(1, busiest->capacity - 1);
  if (tiles_[tile.value].all_cost_us >= wait_us) return {};
  busiest->waiting.pop_back();
  busiest->waiting_us -= tiles_[tile.value].cost_us;
  return tile;
}

double Scheduler::expected_us(TileId tile) const {
  const double cost_us = tiles_[tile.value].cost_us;
  return cost_us > 0 ? cost_us : spare_us_;
}

bool Scheduler::has_room(const Worker& worker) const {
  if (std::cmp_less(worker.held.size(), worker.capacity)) return true;
  return worker.held.size() < kMostHeld && worker.held_us < spare_us_ * (worker.capacity - 1);
}

std::optional<Quantum> Scheduler::next(int worker) {
  Worker& taker = workers_.at(static_cast<std::size_t>(worker));
  if (taker.lost || !has_room(taker)) return {};
  const auto tile = take(worker);
  if (!tile) return {};
  taker.held.push_back(*tile);
  taker.held_us += expected_us(*tile);
  tiles_[tile->value].owner = worker;
  return Quantum{*tile, Step{static_cast<std::uint16_t>(step_.value - 1)}, step_};
}

Finished Scheduler::done(int worker, TileId tile, Step to, double squared_error) {
  auto& held = workers_.at(static_cast<std::size_t>(worker)).held;
  const auto found = std::find(held.begin(), held.end(), tile);
  if (found == held.end() || to != step_) return Finished::kNot;
  held.erase(found);
  workers_[static_cast<std::size_t>(worker)].held_us -= expected_us(tile);
  Tile& finished = tiles_[tile.value];
  squared_errors_[tile.value] = squared_error;
  finished.done_by = worker;
  --open_;
  return finished.again ? Finished::kAgain : Finished::kFirst;
}

std::vector<TileId> Scheduler::take_back(int worker) {
  std::vector<TileId> again;
  if (finished()) return again;
  for (std::uint32_t i = 0; i < tiles_.size(); ++i) {
    Tile& tile = tiles_[i];
    if (tile.done_by != worker) continue;
    tile.done_by = -1;
    tile.again = true;
    again.push_back({i});
  }
  open_ += again.size();
  return again;
}

void Scheduler::worker_lost(int worker) {
  Worker& lost = workers_.at(static_cast<std::size_t>(worker));
  lost.lost = true;
  const auto again = take_back(worker);
  unowned_.insert(unowned_.begin(), again.begin(), again.end());
  unowned_.insert(unowned_.begin(), lost.waiting.begin(), lost.waiting.end());
  unowned_.insert(unowned_.begin(), lost.held.begin(), lost.held.end());
  lost.held.clear();
  lost.held_us = 0;
  lost.waiting.clear();
  lost.waiting_us = 0;
  for (Tile& tile : tiles_)
    if (tile.owner == worker) tile.owner = -1;
}

}  // namespace goldthread
