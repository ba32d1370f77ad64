// SPDX-License-Identifier: Apache-2.0
#include "master/scheduler.h"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

namespace goldthread {

Scheduler::Scheduler(const std::vector<int>& capacity) {
  for (const int places : capacity) workers_.push_back({places, {}});
}

void Scheduler::begin_view(const TileGrid& grid, std::span<const Level> levels,
                           const CostHistory& costs) {
  for (Worker& worker : workers_) worker.held.clear();
  queue_.clear();
  returned_.clear();
  done_.clear();
  next_ = 0;
  Level from = kNoLevel;
  for (const Level to : levels) {
    append_level(grid, from, to, costs);
    done_.emplace_back(to, 0);
    from = to;
  }
  open_ = queue_.size();
}

void Scheduler::append_level(const TileGrid& grid, Level from, Level to, const CostHistory& costs) {
  std::vector<std::pair<double, Quantum>> ordered;
  std::map<std::pair<int, int>, std::uint64_t> rays_of_size;  // few distinct sizes in a grid
  for (std::uint32_t i = 0; i < grid.count(); ++i) {
    const TileId tile{i};
    const PixelRect rect = grid.rect(tile);
    auto& rays = rays_of_size[{rect.width, rect.height}];
    if (rays == 0) rays = new_samples({rect.width, rect.height}, from, to).size();
    ordered.push_back({costs.predict_us(tile, rays), {tile, from, to}});
  }
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [cost, quantum] : ordered) queue_.push_back(quantum);
}

std::optional<Quantum> Scheduler::next(int worker) {
  Worker& taker = workers_.at(static_cast<std::size_t>(worker));
  if (std::cmp_greater_equal(taker.held.size(), taker.capacity)) return {};
  std::size_t place = next_;
  if (!returned_.empty()) {
    place = returned_.back();
    returned_.pop_back();
  } else if (next_ < queue_.size()) {
    ++next_;
  } else {
    return {};
  }
  taker.held.push_back(place);
  return queue_[place];
}

bool Scheduler::done(int worker, TileId tile, Level to) {
  auto& held = workers_.at(static_cast<std::size_t>(worker)).held;
  const auto found = std::find_if(held.begin(), held.end(), [&](std::size_t place) {
    return queue_[place].tile == tile && queue_[place].to == to;
  });
  if (found == held.end()) return false;
  held.erase(found);
  --open_;
  for (auto& [level, count] : done_) count += level == to ? 1 : 0;
  return true;
}

void Scheduler::worker_lost(int worker) {
  Worker& lost = workers_.at(static_cast<std::size_t>(worker));
  returned_.insert(returned_.end(), lost.held.begin(), lost.held.end());
  std::sort(returned_.begin(), returned_.end(), std::greater<>());
  lost.held.clear();
  lost.capacity = 0;
}

std::size_t Scheduler::done_at(Level level) const {
  for (const auto& [at, count] : done_) {
    if (at == level) return count;
  }
  return 0;
}

}  // namespace goldthread
