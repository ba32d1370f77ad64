// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/scheduling.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace goldthread::bench {
namespace {

std::chrono::microseconds microseconds_of(const StepCost& cost) {
  return std::chrono::microseconds(std::int64_t(cost.us));
}

/// A part of a picture is a row of tiles to its scheduler.
TileGrid grid_of(const TileGrid& whole, std::size_t tiles) {
  if (tiles == whole.count()) return whole;
  return {{static_cast<int>(tiles) * whole.tile.width, whole.tile.height}, whole.tile};
}

}  // namespace

Scheduling::Scheduling(const FrameWork& before, std::vector<std::uint32_t> tiles, int workers,
                       int capacity, const Strategy& strategy)
    : workers_(workers),
      tiles_(std::move(tiles)),
      grid_(grid_of(before.grid, tiles_.size())),
      last_{static_cast<std::uint16_t>(std::max<std::size_t>(1, before.steps.size()))},
      scheduler_(std::vector<int>(std::size_t(workers), capacity), strategy) {
  costs_.fit(grid_);
  Step step{1};
  for (const std::vector<StepCost>& known : before.steps) {
    for (std::uint32_t i = 0; i < tiles_.size(); ++i)
      costs_.record({i}, step, microseconds_of(known[tiles_[i]]));
    step = step.next();
  }
}

void Scheduling::open() {
  if (scheduler_.step() == kNoStep)
    scheduler_.begin_view(grid_, costs_, last_);
  else
    scheduler_.open_step(costs_);
}

std::span<const std::uint32_t> Scheduling::next(int worker) {
  quantum_.clear();
  if (const auto quantum = scheduler_.next(worker)) {
    quantum_.push_back(tiles_[quantum->tile.value]);
    while (const auto joined = scheduler_.join(worker)) quantum_.push_back(tiles_[joined->value]);
  }
  return quantum_;
}

void Scheduling::done(int worker, std::uint32_t tile, const StepCost& cost) {
  const auto found = std::lower_bound(tiles_.begin(), tiles_.end(), tile);
  const TileId own{static_cast<std::uint32_t>(found - tiles_.begin())};
  scheduler_.done(worker, own, scheduler_.step(), cost.squared_error);
  costs_.record(own, scheduler_.step(), microseconds_of(cost));
}

}  // namespace goldthread::bench
