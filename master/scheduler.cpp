// SPDX-License-Identifier: Apache-2.0
#include "master/scheduler.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace goldthread {

Scheduler::Scheduler(const std::vector<int>& capacity) : longest_wait_(capacity.size()) {
  for (const int places : capacity) {
    Worker worker;
    worker.capacity = places;
    workers_.push_back(std::move(worker));
  }
}

void Scheduler::begin_view(const TileGrid& grid, const CostHistory& costs) {
  for (Worker& worker : workers_) worker.held.clear();
  tiles_.assign(grid.count(), {});
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
  longest_wait_ = LargestOf(workers_.size());
  unowned_.clear();
  std::vector<double> urgency(tiles_.size());
  for (std::uint32_t i = 0; i < tiles_.size(); ++i) {
    Tile& tile = tiles_[i];
    tile.done_by = -1;
    tile.again = false;
    tile.cost_us = costs.predict_us({i}, step_);
    tile.all_cost_us = costs.predict_all_us({i}, step_);
    // Errors are sums over the tile: its area is in them.
    urgency[i] = step_ == Step{1} ? tile.cost_us : tile.squared_error / std::max(tile.cost_us, 1.0);
  }
  std::vector<std::uint32_t> order(tiles_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return urgency[a] > urgency[b]; });
  for (const std::uint32_t i : order) {
    if (tiles_[i].owner < 0) {
      unowned_.push_back({i});
      continue;
    }
    const auto owner = static_cast<std::size_t>(tiles_[i].owner);
    workers_[owner].waiting.push_back({i});
    add_waiting(owner, tiles_[i].cost_us);
  }
  open_ = tiles_.size();
}

void Scheduler::add_waiting(std::size_t worker, double us) {
  Worker& owner = workers_[worker];
  owner.waiting_us += us;
  longest_wait_.set(worker, owner.waiting_us / std::max(1, owner.capacity));
}

std::optional<TileId> Scheduler::take(int worker) {
  Worker& own = workers_[static_cast<std::size_t>(worker)];
  if (!own.waiting.empty()) {
    const TileId tile = own.waiting.front();
    own.waiting.pop_front();
    add_waiting(static_cast<std::size_t>(worker), -tiles_[tile.value].cost_us);
    return tile;
  }
  if (unowned_.empty()) return take_over(worker);
  const TileId tile = unowned_.front();
  unowned_.pop_front();
  return tile;
}

std::optional<TileId> Scheduler::take_over(int worker) {
  const std::size_t index = longest_wait_.index();
  Worker& busiest = workers_[index];
  if (busiest.waiting.empty() || std::cmp_equal(index, worker)) return {};
  // The last one waits longest: until its owner has come through all before it.
  const TileId tile = busiest.waiting.back();
  const double wait_us = busiest.waiting_us / std::max(1, busiest.capacity - 1);
  if (tiles_[tile.value].all_cost_us >= wait_us) return {};
  busiest.waiting.pop_back();
  add_waiting(index, -tiles_[tile.value].cost_us);
  return tile;
}

std::optional<Quantum> Scheduler::next(int worker) {
  Worker& taker = workers_.at(static_cast<std::size_t>(worker));
  if (taker.lost || std::cmp_greater_equal(taker.held.size(), taker.capacity)) return {};
  const auto tile = take(worker);
  if (!tile) return {};
  taker.held.push_back(*tile);
  tiles_[tile->value].owner = worker;
  return Quantum{*tile, Step{static_cast<std::uint16_t>(step_.value - 1)}, step_};
}

Finished Scheduler::done(int worker, TileId tile, Step to, double squared_error) {
  auto& held = workers_.at(static_cast<std::size_t>(worker)).held;
  const auto found = std::find(held.begin(), held.end(), tile);
  if (found == held.end() || to != step_) return Finished::kNot;
  held.erase(found);
  Tile& finished = tiles_[tile.value];
  finished.squared_error = squared_error;
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
  lost.waiting.clear();
  add_waiting(static_cast<std::size_t>(worker), -lost.waiting_us);
  for (Tile& tile : tiles_)
    if (tile.owner == worker) tile.owner = -1;
}

}  // namespace goldthread
