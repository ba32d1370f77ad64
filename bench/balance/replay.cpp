// SPDX-License-Identifier: Apache-2.0
#include "bench/balance/replay.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <queue>

#include "master/balance.h"

namespace goldthread::bench {
namespace {

/// One thread, and a spare quantum, as the master counts them.
constexpr int kPlaces = 2;

class Replay {
 public:
  Replay(const CastFrame& frame, CostHistory costs, int workers, Strategy strategy)
      : frame_(frame),
        costs_(std::move(costs)),
        scheduler_(std::vector(std::size_t(workers), kPlaces), strategy),
        workers_(std::size_t(workers)),
        holder_(frame.grid.count(), -1) {
    costs_.fit(frame.grid);
  }

  Replayed run() {
    scheduler_.begin_view(frame_.grid, costs_, costs_.empty() ? Step{1} : costs_.last_step());
    for (const CastFrame::Step& step : frame_.steps) {
      run_step(step);
      if (&step != &frame_.steps.back()) scheduler_.open_step(costs_);
    }
    std::vector<double> busy;
    for (const Worker& worker : workers_) busy.push_back(worker.busy_us);
    return {1e-6 * now_us_, imbalance(busy)};
  }

 private:
  struct Worker {
    std::deque<std::uint32_t> tiles;  ///< in the order in which it casts them
    double busy_us = 0;
  };
  /// When a worker has cast its first tile.
  using Event = std::pair<double, int>;
  using Events = std::priority_queue<Event, std::vector<Event>, std::greater<>>;

  void run_step(const CastFrame::Step& step) {
    Events events;
    for (bool any = true; any;) {
      any = false;
      for (int w = 0; w < int(workers_.size()); ++w) any = give(w, events) || any;
    }
    while (!events.empty()) {
      const auto [time, w] = events.top();
      events.pop();
      now_us_ = time;
      Worker& worker = workers_[std::size_t(w)];
      const std::uint32_t tile = worker.tiles.front();
      worker.tiles.pop_front();
      if (!worker.tiles.empty()) begin(w, events);
      scheduler_.done(w, {tile}, scheduler_.step(), step.squared_error[tile]);
      while (give(w, events)) {
      }
      costs_.record({tile}, scheduler_.step(),
                    std::chrono::microseconds(std::llround(step.us[tile])));
    }
  }

  bool give(int w, Events& events) {
    const auto quantum = scheduler_.next(w);
    if (!quantum) return false;
    auto& tiles = workers_[std::size_t(w)].tiles;
    const bool idle = tiles.empty();
    tiles.push_back(quantum->tile.value);
    while (const auto tile = scheduler_.join(w)) tiles.push_back(tile->value);
    if (idle) begin(w, events);
    return true;
  }

  void begin(int w, Events& events) {
    Worker& worker = workers_[std::size_t(w)];
    const std::uint32_t tile = worker.tiles.front();
    const std::size_t last = scheduler_.step().value;
    double us = 0;
    for (std::size_t s = holder_[tile] == w ? last - 1 : 0; s < last; ++s)
      us += frame_.steps[s].us[tile];
    holder_[tile] = w;
    worker.busy_us += us;
    events.emplace(now_us_ + us, w);
  }

  const CastFrame& frame_;
  CostHistory costs_;
  Scheduler scheduler_;
  std::vector<Worker> workers_;
  std::vector<int> holder_;  ///< of each tile's state
  double now_us_ = 0;
};

}  // namespace

Replayed replay(const CastFrame& frame, CostHistory predicted, int workers, Strategy strategy) {
  return Replay(frame, std::move(predicted), workers, strategy).run();
}

}  // namespace goldthread::bench
