// SPDX-License-Identifier: Apache-2.0
#include "master/scheduler.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>
#include <utility>

namespace goldthread {

Scheduler::Scheduler(const std::vector<int>& capacity, Strategy strategy)
    : strategy_(strategy), longest_wait_(capacity.size()) {
  for (const int places : capacity) {
    Worker worker;
    worker.capacity = places;
    workers_.push_back(std::move(worker));
  }
  count_threads();
}

void Scheduler::begin_view(const TileGrid& grid, const CostHistory& costs, Step last) {
  for (Worker& worker : workers_) {
    worker.held.clear();
    worker.held_us = 0;
  }
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
    worker.held_us = 0;
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

void Scheduler::count_threads() {
  threads_ = 0;
  for (const Worker& worker : workers_) threads_ += worker.lost ? 0 : worker.threads();
  threads_ = std::max(1, threads_);
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

int Scheduler::source_for(int worker) const {
  constexpr int kNobody = -1;
  return workers_[static_cast<std::size_t>(worker)].waiting.tiles.empty() ? kNobody : worker;
}

void Scheduler::put(int owner, TileId tile) {
  Queue& queue = queue_of(owner);
  queue.tiles.push_back(tile);
  queue.us += tiles_[tile.value].cost_us;
  note_waiting(owner);
}

TileId Scheduler::take(int owner, const std::deque<TileId>::const_iterator& at) {
  Queue& queue = queue_of(owner);
  const TileId tile = *at;
  queue.tiles.erase(at);
  queue.us -= tiles_[tile.value].cost_us;
  note_waiting(owner);
  return tile;
}

void Scheduler::note_waiting(int owner) {
  if (owner < 0) return;
  const auto index = static_cast<std::size_t>(owner);
  longest_wait_.set(index, workers_[index].waiting.us / workers_[index].threads());
}

void Scheduler::queue(const CostHistory& costs) {
  for (Worker& worker : workers_) worker.waiting = {};
  longest_wait_ = LargestOf(workers_.size());
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
    put(owner, {i});
  }
  open_ = tiles_.size();
  joined_us_ = std::min(kJoinedUs, kJoinedShare * total_us / threads_);
}

bool Scheduler::is_due(const Worker& taker, TileId tile, double waiting_us, int threads) const {
  if (std::cmp_less(taker.held.size(), taker.threads())) return true;
  if (taker.threads() == threads_) return true;  // there is nobody else
  const double cost_us = tiles_[tile.value].cost_us;
  // Nobody would take over what has so much more to it than this step.
  if (tiles_[tile.value].all_cost_us > kSpareRounds * cost_us) return true;
  return cost_us <= joined_us_ || waiting_us >= kSpareRounds * threads * cost_us;
}

std::optional<TileId> Scheduler::take(int worker) {
  Worker& taker = workers_[static_cast<std::size_t>(worker)];
  const int source = source_for(worker);
  const Queue& queue = queue_of(source);
  if (queue.tiles.empty())
    return strategy_.share == Share::kOnDemand ? take_over(worker) : std::nullopt;
  // What it was dealt once and for all nobody else waits for.
  const bool own = source == worker;
  if (strategy_.share == Share::kOnDemand &&
      !is_due(taker, queue.tiles.front(), queue.us, own ? taker.threads() : threads_))
    return {};
  return take(source, queue.tiles.begin());
}

double Scheduler::held_us(const Worker& worker) const {
  double us = 0;
  for (const auto& quantum : worker.held)
    for (const TileId tile : quantum) us += tiles_[tile.value].cost_us;
  return us;
}

std::optional<TileId> Scheduler::take_over(int worker) {
  const std::size_t index = longest_wait_.index();
  const Queue& queue = workers_[index].waiting;
  const Worker& busiest = workers_[index];
  if (queue.tiles.empty() || std::cmp_equal(index, worker)) return {};
  // Of what the owner holds about half is done.
  const double held = held_us(busiest) / 2;
  const auto end_without = [&](double us) { return (queue.us + held - us) / busiest.threads(); };
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
  if (!is_due(taker, *best, queue.us, busiest.threads())) return {};
  return take(static_cast<int>(index), best);
}

double Scheduler::expected_us(TileId tile) const {
  const double cost_us = tiles_[tile.value].cost_us;
  if (cost_us > 0 || strategy_.share != Share::kOnDemand) return cost_us;
  return strategy_.spare_us;
}

bool Scheduler::has_room(const Worker& worker) const {
  if (std::cmp_less(worker.held.size(), worker.capacity)) return true;
  return worker.held.size() < kMostHeld && worker.held_us < strategy_.spare_us * worker.threads();
}

void Scheduler::hold(Worker& worker, TileId tile) {
  worker.held.back().push_back(tile);
  worker.held_us += expected_us(tile);
}

std::optional<Quantum> Scheduler::next(int worker) {
  Worker& taker = workers_.at(static_cast<std::size_t>(worker));
  if (taker.lost || !has_room(taker)) return {};
  const auto tile = take(worker);
  if (!tile) return {};
  taker.held.emplace_back();
  taker.newest_us = tiles_[tile->value].cost_us;
  hold(taker, *tile);
  tiles_[tile->value].owner = worker;
  return Quantum{*tile, Step{static_cast<std::uint16_t>(step_.value - 1)}, step_};
}

std::optional<TileId> Scheduler::join(int worker) {
  Worker& taker = workers_.at(static_cast<std::size_t>(worker));
  const int source = source_for(worker);
  const Queue& queue = queue_of(source);
  if (joined_us_ <= 0 || taker.held.empty() || taker.held.back().size() >= kMostJoined ||
      queue.tiles.empty())
    return {};
  const double with_it = taker.newest_us + tiles_[queue.tiles.front().value].cost_us;
  if (with_it > joined_us_) return {};
  const TileId tile = take(source, queue.tiles.begin());
  taker.newest_us = with_it;
  hold(taker, tile);
  tiles_[tile.value].owner = worker;
  return tile;
}

Finished Scheduler::done(int worker, TileId tile, Step to, double squared_error) {
  Worker& doer = workers_.at(static_cast<std::size_t>(worker));
  auto& held = doer.held;
  const auto quantum = std::find_if(held.begin(), held.end(), [&](const auto& tiles) {
    return std::find(tiles.begin(), tiles.end(), tile) != tiles.end();
  });
  if (quantum == held.end() || to != step_) return Finished::kNot;
  std::erase(*quantum, tile);
  if (quantum->empty()) held.erase(quantum);
  doer.held_us -= expected_us(tile);
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
  count_threads();
  Queue again;
  const auto give_back = [&](const auto& tiles) {
    for (const TileId tile : tiles) {
      again.tiles.push_back(tile);
      again.us += tiles_[tile.value].cost_us;
    }
  };
  for (const auto& quantum : lost.held) give_back(quantum);
  give_back(lost.waiting.tiles);
  give_back(take_back(worker));
  give_back(unowned_.tiles);
  unowned_ = std::move(again);
  lost.held.clear();
  lost.held_us = 0;
  lost.waiting = {};
  note_waiting(worker);
  for (Tile& tile : tiles_)
    if (tile.owner == worker) tile.owner = -1;
}

}  // namespace goldthread
