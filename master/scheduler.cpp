// SPDX-License-Identifier: Apache-2.0
#include "master/scheduler.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace goldthread {

Scheduler::Scheduler(const std::vector<int>& capacity, Strategy strategy) : strategy_(strategy) {
  for (const int places : capacity) {
    Worker worker;
    worker.capacity = places;
    workers_.push_back(std::move(worker));
  }
}

void Scheduler::begin_view(const TileGrid& grid, const CostHistory& costs) {
  for (Worker& worker : workers_) worker.held.clear();
  tiles_.assign(grid.count(), {});
  share_out();
  step_ = Step{1};
  queue(costs);
}

void Scheduler::share_out() {
  if (strategy_.share == Share::kOnDemand) return;
  std::vector<int> alive;
  for (std::size_t w = 0; w < workers_.size(); ++w)
    if (!workers_[w].lost) alive.push_back(static_cast<int>(w));
  for (std::size_t i = 0; i < tiles_.size() && !alive.empty(); ++i)
    tiles_[i].owner = alive[strategy_.share == Share::kContiguous ? i * alive.size() / tiles_.size()
                                                                  : i % alive.size()];
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
  unowned_.clear();
  std::vector<double> urgency(tiles_.size());
  double total_us = 0;
  for (std::uint32_t i = 0; i < tiles_.size(); ++i) {
    Tile& tile = tiles_[i];
    tile.done_by = -1;
    tile.again = false;
    tile.cost_us = costs.predict_us({i}, step_);
    tile.all_cost_us = costs.predict_all_us({i}, step_);
    total_us += tile.cost_us;
    if (strategy_.order == Order::kScreen) continue;  // all alike: they keep their order
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
    Worker& owner = workers_[static_cast<std::size_t>(tiles_[i].owner)];
    owner.waiting.push_back({i});
    owner.waiting_us += tiles_[i].cost_us;
  }
  open_ = tiles_.size();
  int threads = 0;
  for (const Worker& worker : workers_)
    if (!worker.lost) threads += std::max(1, worker.capacity - 1);
  joined_us_ = std::min(kJoinedUs, kJoinedShare * total_us / std::max(1, threads));
}

std::deque<TileId>& Scheduler::waiting_for(Worker& worker) {
  return worker.waiting.empty() ? unowned_ : worker.waiting;
}

TileId Scheduler::pop(Worker& worker) {
  auto& waiting = waiting_for(worker);
  const TileId tile = waiting.front();
  if (&waiting == &worker.waiting) worker.waiting_us -= tiles_[tile.value].cost_us;
  waiting.pop_front();
  return tile;
}

std::optional<TileId> Scheduler::take(int worker) {
  Worker& taker = workers_[static_cast<std::size_t>(worker)];
  if (!waiting_for(taker).empty()) return pop(taker);
  if (strategy_.share != Share::kOnDemand) return {};
  return take_over(worker);
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

std::optional<Quantum> Scheduler::next(int worker) {
  Worker& taker = workers_.at(static_cast<std::size_t>(worker));
  if (taker.lost || std::cmp_greater_equal(taker.held.size(), taker.capacity)) return {};
  const auto tile = take(worker);
  if (!tile) return {};
  taker.held.push_back({*tile});
  taker.newest_us = tiles_[tile->value].cost_us;
  tiles_[tile->value].owner = worker;
  return Quantum{*tile, Step{static_cast<std::uint16_t>(step_.value - 1)}, step_};
}

std::optional<TileId> Scheduler::join(int worker) {
  Worker& taker = workers_.at(static_cast<std::size_t>(worker));
  if (joined_us_ <= 0 || taker.held.empty() || taker.held.back().size() >= kMostJoined ||
      waiting_for(taker).empty())
    return {};
  const double with_it = taker.newest_us + tiles_[waiting_for(taker).front().value].cost_us;
  if (with_it > joined_us_) return {};
  const TileId tile = pop(taker);
  taker.newest_us = with_it;
  taker.held.back().push_back(tile);
  tiles_[tile.value].owner = worker;
  return tile;
}

Finished Scheduler::done(int worker, TileId tile, Step to, double squared_error) {
  auto& held = workers_.at(static_cast<std::size_t>(worker)).held;
  const auto quantum = std::find_if(held.begin(), held.end(), [&](const auto& tiles) {
    return std::find(tiles.begin(), tiles.end(), tile) != tiles.end();
  });
  if (quantum == held.end() || to != step_) return Finished::kNot;
  std::erase(*quantum, tile);
  if (quantum->empty()) held.erase(quantum);
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
  for (auto quantum = lost.held.rbegin(); quantum != lost.held.rend(); ++quantum)
    unowned_.insert(unowned_.begin(), quantum->begin(), quantum->end());
  lost.held.clear();
  lost.waiting.clear();
  lost.waiting_us = 0;
  for (Tile& tile : tiles_)
    if (tile.owner == worker) tile.owner = -1;
}

}  // namespace goldthread
