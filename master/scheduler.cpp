// SPDX-License-Identifier: Apache-2.0
#include "master/scheduler.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>
#include <utility>

namespace goldthread {

Scheduler::Scheduler(const std::vector<int>& capacity, Strategy strategy) : strategy_(strategy) {
  for (const int places : capacity) {
    Worker worker;
    worker.capacity = places;
    workers_.push_back(std::move(worker));
  }
}

void Scheduler::begin_view(const TileGrid& grid, const CostHistory& costs, Step last) {
  for (Worker& worker : workers_) worker.held.clear();
  tiles_.assign(grid.count(), {});
  step_ = Step{1};
  last_ = last;
  if (strategy_.share != Share::kOnDemand)
    deal_alike();
  else if (strategy_.order == Order::kUrgent && last > step_)
    deal_by_cost(costs);
  queue(costs);
}

void Scheduler::open_step(const CostHistory& costs) {
  step_ = step_.next();
  queue(costs);
}

void Scheduler::cancel() {
  for (Worker& worker : workers_) {
    worker.held.clear();
    worker.waiting = {};
  }
  unowned_ = {};
  open_ = 0;
}

std::vector<int> Scheduler::alive() const {
  std::vector<int> alive;
  for (std::size_t w = 0; w < workers_.size(); ++w)
    if (!workers_[w].lost) alive.push_back(static_cast<int>(w));
  return alive;
}

int Scheduler::threads() const {
  int threads = 0;
  for (const Worker& worker : workers_) threads += worker.lost ? 0 : worker.threads();
  return std::max(1, threads);
}

void Scheduler::deal_alike() {
  const auto workers = alive();
  for (std::size_t i = 0; i < tiles_.size() && !workers.empty(); ++i)
    tiles_[i].owner =
        workers[strategy_.share == Share::kContiguous ? i * workers.size() / tiles_.size()
                                                      : i % workers.size()];
}

/// The longest first, each to the worker that has the least to do (Graham 1969, "Bounds on
/// multiprocessing timing anomalies").
void Scheduler::deal_by_cost(const CostHistory& costs) {
  const auto workers = alive();
  if (workers.empty()) return;
  std::vector<double> us(tiles_.size());
  // No tile is for nothing: else one worker would be dealt all that are cheap.
  for (std::uint32_t i = 0; i < tiles_.size(); ++i)
    us[i] = std::max(1.0, costs.predict_all_us({i}, last_));
  std::vector<std::uint32_t> order(tiles_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return us[a] > us[b]; });
  using Load = std::pair<double, int>;  // for each thread, and whose
  std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
  for (const int worker : workers) loads.emplace(0, worker);
  for (const std::uint32_t i : order) {
    const auto [load, worker] = loads.top();
    loads.pop();
    tiles_[i].owner = worker;
    loads.emplace(load + us[i] / workers_[static_cast<std::size_t>(worker)].threads(), worker);
  }
}

void Scheduler::put(Queue& queue, TileId tile) {
  queue.tiles.push_back(tile);
  queue.us += tiles_[tile.value].cost_us;
}

TileId Scheduler::take(Queue& queue, std::deque<TileId>::const_iterator at) {
  const TileId tile = *at;
  queue.tiles.erase(at);
  queue.us -= tiles_[tile.value].cost_us;
  return tile;
}

void Scheduler::queue(const CostHistory& costs) {
  for (Worker& worker : workers_) worker.waiting = {};
  unowned_ = {};
  std::vector<double> urgency(tiles_.size());
  double total_us = 0;
  for (std::uint32_t i = 0; i < tiles_.size(); ++i) {
    Tile& tile = tiles_[i];
    tile.done_by = -1;
    tile.again = false;
    tile.cost_us = tile.all_cost_us = 0;
    if (strategy_.order == Order::kScreen) continue;  // all alike: they keep their order
    tile.cost_us = costs.predict_us({i}, step_);
    tile.all_cost_us = costs.predict_all_us({i}, std::max(step_, last_));
    total_us += tile.cost_us;
    // Errors are sums over the tile: its area is in them.
    urgency[i] = step_ == Step{1} ? tile.cost_us : tile.squared_error / std::max(tile.cost_us, 1.0);
  }
  std::vector<std::uint32_t> order(tiles_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return urgency[a] > urgency[b]; });
  for (const std::uint32_t i : order) {
    const int owner = tiles_[i].owner;
    put(owner < 0 ? unowned_ : workers_[static_cast<std::size_t>(owner)].waiting, {i});
  }
  open_ = tiles_.size();
  joined_us_ = std::min(kJoinedUs, kJoinedShare * total_us / threads());
}

bool Scheduler::is_due(const Worker& taker, TileId tile, double waiting_us, int threads) const {
  if (std::cmp_less(taker.held.size(), taker.threads())) return true;
  const double cost_us = tiles_[tile.value].cost_us;
  // Nobody would take over what has so much more to it than this step.
  if (tiles_[tile.value].all_cost_us > kSpareRounds * cost_us) return true;
  return cost_us <= joined_us_ || waiting_us >= kSpareRounds * threads * cost_us;
}

std::optional<TileId> Scheduler::take(int worker) {
  Worker& taker = workers_[static_cast<std::size_t>(worker)];
  Queue& queue = queue_for(taker);
  if (queue.tiles.empty())
    return strategy_.share == Share::kOnDemand ? take_over(worker) : std::nullopt;
  // What it was dealt once and for all nobody else waits for.
  const bool own = &queue == &taker.waiting;
  if (strategy_.share == Share::kOnDemand &&
      !is_due(taker, queue.tiles.front(), queue.us, own ? taker.threads() : threads()))
    return {};
  return take(queue, queue.tiles.begin());
}

double Scheduler::held_us(const Worker& worker) const {
  double us = 0;
  for (const auto& quantum : worker.held)
    for (const TileId tile : quantum) us += tiles_[tile.value].cost_us;
  return us;
}

std::optional<TileId> Scheduler::take_over(int worker) {
  const auto busiest =
      std::max_element(workers_.begin(), workers_.end(), [](const Worker& a, const Worker& b) {
        return a.waiting.us / a.threads() < b.waiting.us / b.threads();
      });
  Queue& queue = busiest->waiting;
  if (queue.tiles.empty() || std::cmp_equal(busiest - workers_.begin(), worker)) return {};
  // Of what the owner holds about half is done.
  const double held = held_us(*busiest) / 2;
  const auto end_without = [&](double us) { return (queue.us + held - us) / busiest->threads(); };
  // The one with which both end soonest; of equals the last one, which waits longest.
  auto best = queue.tiles.end();
  double soonest = end_without(0);
  for (auto at = queue.tiles.begin(); at != queue.tiles.end(); ++at) {
    const Tile& tile = tiles_[at->value];
    const double end = std::max(end_without(tile.cost_us), tile.all_cost_us);
    if (tile.all_cost_us >= end_without(0) || end > soonest) continue;
    soonest = end;
    best = at;
  }
  if (best == queue.tiles.end()) return {};
  Worker& taker = workers_[static_cast<std::size_t>(worker)];
  if (!is_due(taker, *best, queue.us, busiest->threads())) return {};
  return take(queue, best);
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
  Queue& queue = queue_for(taker);
  if (joined_us_ <= 0 || taker.held.empty() || taker.held.back().size() >= kMostJoined ||
      queue.tiles.empty())
    return {};
  const double with_it = taker.newest_us + tiles_[queue.tiles.front().value].cost_us;
  if (with_it > joined_us_) return {};
  const TileId tile = take(queue, queue.tiles.begin());
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
  Queue again;
  for (const auto& quantum : lost.held)
    for (const TileId tile : quantum) put(again, tile);
  for (const TileId tile : lost.waiting.tiles) put(again, tile);
  for (const TileId tile : take_back(worker)) put(again, tile);
  for (const TileId tile : unowned_.tiles) put(again, tile);
  unowned_ = std::move(again);
  lost.held.clear();
  lost.waiting = {};
  for (Tile& tile : tiles_)
    if (tile.owner == worker) tile.owner = -1;
}

}  // namespace goldthread
