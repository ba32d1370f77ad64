// SPDX-License-Identifier: Apache-2.0
#include "master/scheduler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <queue>
#include <random>
#include <set>
#include <tuple>

#include "master/levels.h"

namespace goldthread {
namespace {

using Key = std::pair<std::uint32_t, int>;  // tile, level

Key key_of(const Quantum& quantum) { return {quantum.tile.value, quantum.to.log2_spacing}; }

/// A grid of `tiles` equal tiles in one row.
TileGrid row_of(int tiles) { return TileGrid::squares({64 * tiles, 64}, 64); }

/// A history in which each ray of tile i costs costs[i] µs.
CostHistory history(const TileGrid& grid, const std::vector<int>& costs) {
  CostHistory result;
  result.fit(grid);
  for (std::uint32_t i = 0; i < costs.size(); ++i) {
    result.record({i}, 1, std::chrono::microseconds(costs[i]));
  }
  return result;
}

std::vector<int> random_costs(std::size_t count, std::mt19937& random) {
  std::vector<int> costs(count);
  for (int& cost : costs) cost = std::uniform_int_distribution(1, 1000)(random);
  return costs;
}

Scheduler begun(std::vector<int> capacity, const TileGrid& grid, const std::vector<Level>& levels,
                const CostHistory& costs = {}) {
  Scheduler scheduler(std::move(capacity));
  scheduler.begin_view(grid, levels, costs);
  return scheduler;
}

TEST(Scheduler, GivesOutDescendingPredictedCostWithinALevelAndLevelsInOrder) {
  std::mt19937 random(1);
  const TileGrid grid = row_of(50);
  const CostHistory costs = history(grid, random_costs(grid.count(), random));
  const auto levels = progressive_levels();
  Scheduler scheduler = begun({1000}, grid, levels, costs);
  Level from = kNoLevel;
  for (const Level level : levels) {
    double before = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < grid.count(); ++i) {
      const auto quantum = scheduler.next(0);
      ASSERT_TRUE(quantum);
      EXPECT_EQ(quantum->from, from);
      EXPECT_EQ(quantum->to, level);
      const double cost = costs.predict_us(quantum->tile, 1);
      EXPECT_LE(cost, before);
      before = cost;
    }
    from = level;
  }
  EXPECT_FALSE(scheduler.next(0));
}

TEST(Scheduler, KeepsTheOrderOfTilesThatCostTheSame) {
  Scheduler scheduler = begun({100}, row_of(20), direct_levels());
  for (std::uint32_t i = 0; i < 20; ++i) EXPECT_EQ(scheduler.next(0)->tile, TileId{i});
}

TEST(Scheduler, CountsWhatIsDoneAtEachLevel) {
  const TileGrid grid = row_of(3);
  Scheduler scheduler = begun({100}, grid, progressive_levels());
  EXPECT_EQ(scheduler.open(), 15u);
  for (std::size_t done = 1; done <= 15; ++done) {
    const auto quantum = scheduler.next(0);
    ASSERT_TRUE(scheduler.done(0, quantum->tile, quantum->to));
    EXPECT_EQ(scheduler.open(), 15 - done);
    EXPECT_EQ(scheduler.done_at(quantum->to), (done - 1) % 3 + 1);
    EXPECT_EQ(scheduler.finished(), done == 15);
  }
}

TEST(Scheduler, GivesAWorkerNoMoreThanItsCapacity) {
  Scheduler scheduler = begun({2, 0, 3}, row_of(10), direct_levels());
  EXPECT_TRUE(scheduler.next(0));
  const auto second = scheduler.next(0);
  EXPECT_TRUE(second);
  EXPECT_FALSE(scheduler.next(0));
  EXPECT_FALSE(scheduler.next(1));
  EXPECT_TRUE(scheduler.done(0, second->tile, second->to));
  EXPECT_TRUE(scheduler.next(0));
  EXPECT_FALSE(scheduler.next(0));
}

TEST(Scheduler, IgnoresWhatAWorkerDoesNotHold) {
  Scheduler scheduler = begun({2, 2}, row_of(4), progressive_levels());
  const Quantum held = *scheduler.next(0);
  EXPECT_FALSE(scheduler.done(1, held.tile, held.to)) << "another worker's";
  EXPECT_FALSE(scheduler.done(0, held.tile, kPixelLevel)) << "another level";
  EXPECT_FALSE(scheduler.done(0, {99}, held.to)) << "no such tile";
  EXPECT_EQ(scheduler.open(), 20u);
  EXPECT_TRUE(scheduler.done(0, held.tile, held.to));
  EXPECT_FALSE(scheduler.done(0, held.tile, held.to)) << "a second time";
  EXPECT_EQ(scheduler.open(), 19u);
  EXPECT_EQ(scheduler.done_at(held.to), 1u);
}

TEST(Scheduler, ForgetsTheOldViewWhenANewOneBegins) {
  Scheduler scheduler = begun({3}, row_of(4), direct_levels());
  const Quantum old = *scheduler.next(0);
  scheduler.begin_view(row_of(2), direct_levels(), {});
  EXPECT_EQ(scheduler.open(), 2u);
  EXPECT_FALSE(scheduler.done(0, old.tile, old.to)) << "in flight from the old view";
  EXPECT_EQ(scheduler.next(0)->tile, TileId{0});
  EXPECT_EQ(scheduler.next(0)->tile, TileId{1});
  EXPECT_FALSE(scheduler.next(0));
}

TEST(Scheduler, OfAViewWithoutLevelsIsFinished) {
  Scheduler scheduler = begun({3}, row_of(4), {});
  EXPECT_TRUE(scheduler.finished());
  EXPECT_FALSE(scheduler.next(0));
}

TEST(Scheduler, GivesALostWorkersTilesOutAgainFirstOnceAndInTheSameOrder) {
  Scheduler scheduler = begun({3, 100}, row_of(10), progressive_levels());
  std::vector<Quantum> lost;
  while (const auto quantum = scheduler.next(0)) lost.push_back(*quantum);
  ASSERT_EQ(lost.size(), 3u);
  ASSERT_TRUE(scheduler.next(1));
  scheduler.worker_lost(0);
  EXPECT_FALSE(scheduler.next(0)) << "the dead get nothing";
  EXPECT_FALSE(scheduler.done(0, lost[0].tile, lost[0].to)) << "nor does what they send count";
  for (const Quantum& quantum : lost) EXPECT_EQ(scheduler.next(1), quantum);
  EXPECT_EQ(scheduler.next(1)->tile, TileId{4});
  EXPECT_EQ(scheduler.open(), 50u);
}

TEST(Scheduler, GivesOutCoarseTilesOfLostWorkersBeforeFineOnes) {
  // Worker 0 takes the last coarse tile and the first fine one, worker 1 one of each as well.
  Scheduler scheduler = begun({2, 2, 100}, row_of(2), progressive_levels());
  const Quantum coarse = *scheduler.next(0);
  const Quantum coarse_too = *scheduler.next(1);
  const Quantum fine = *scheduler.next(0);
  const Quantum fine_too = *scheduler.next(1);
  scheduler.worker_lost(1);
  scheduler.worker_lost(0);
  for (const Quantum& quantum : {coarse, coarse_too, fine, fine_too}) {
    EXPECT_EQ(scheduler.next(2), quantum);
  }
}

TEST(Scheduler, DoesNotBringALostWorkerBackWithTheNextView) {
  Scheduler scheduler = begun({3, 3}, row_of(4), direct_levels());
  scheduler.worker_lost(0);
  scheduler.begin_view(row_of(4), direct_levels(), {});
  EXPECT_FALSE(scheduler.next(0));
  EXPECT_TRUE(scheduler.next(1));
}

/// Drives a scheduler through a random interleaving and checks its laws at each step.
class RandomRun {
 public:
  explicit RandomRun(unsigned seed) : random_(seed) {
    const int workers = uniform(1, 6);
    std::vector<int> capacity;
    for (int w = 0; w < workers; ++w) capacity.push_back(uniform(1, 4));
    capacity_ = capacity;
    held_.resize(capacity.size());
    grid_ = TileGrid::squares({uniform(1, 300), uniform(1, 300)}, 64);
    const auto costs = history(grid_, random_costs(grid_.count(), random_));
    levels_ = uniform(0, 1) == 0 ? direct_levels() : progressive_levels();
    scheduler_.emplace(std::move(capacity));
    scheduler_->begin_view(grid_, levels_, costs);
  }

  void run() {
    while (!scheduler_->finished() && !::testing::Test::HasFatalFailure()) {
      const auto worker = static_cast<std::size_t>(uniform(0, int(capacity_.size()) - 1));
      const int dice = uniform(0, 99);
      if (dice < 2)
        lose(worker);
      else if (dice < 10)
        lie(worker);
      else if (dice < 55)
        give(worker);
      else
        finish(worker);
    }
    EXPECT_EQ(done_.size(), grid_.count() * levels_.size());
    EXPECT_TRUE(lost_.empty());
    for (const Level level : levels_) EXPECT_EQ(scheduler_->done_at(level), grid_.count());
  }

 private:
  int uniform(int first, int last) { return std::uniform_int_distribution(first, last)(random_); }

  void give(std::size_t worker) {
    const bool room = std::cmp_less(held_[worker].size(), capacity_[worker]);
    const bool work = !lost_.empty() || given_.size() < grid_.count() * levels_.size();
    const auto quantum = scheduler_->next(static_cast<int>(worker));
    ASSERT_EQ(quantum.has_value(), room && work) << "idle while there is work, or too much of it";
    if (!quantum) return;
    const Key key = key_of(*quantum);
    if (lost_.empty()) {
      ASSERT_TRUE(given_.insert(key).second) << "given out twice";
    } else {
      ASSERT_EQ(lost_.erase(key), 1u) << "lost tiles come first";
    }
    held_[worker].push_back(*quantum);
  }
  void finish(std::size_t worker) {
    if (held_[worker].empty()) return;
    const auto at = static_cast<std::size_t>(uniform(0, int(held_[worker].size()) - 1));
    const Quantum quantum = held_[worker][at];
    held_[worker].erase(held_[worker].begin() + std::ptrdiff_t(at));
    ASSERT_TRUE(scheduler_->done(static_cast<int>(worker), quantum.tile, quantum.to));
    ASSERT_TRUE(done_.insert(key_of(quantum)).second) << "done twice";
    ASSERT_EQ(scheduler_->open(), grid_.count() * levels_.size() - done_.size());
  }
  void lie(std::size_t worker) {
    const TileId tile{static_cast<std::uint32_t>(uniform(0, int(grid_.count())))};
    const Level level{static_cast<std::int8_t>(uniform(-1, 5))};
    for (const Quantum& quantum : held_[worker]) {
      if (quantum.tile == tile && quantum.to == level) return;
    }
    ASSERT_FALSE(scheduler_->done(static_cast<int>(worker), tile, level));
  }
  void lose(std::size_t worker) {
    if (std::count_if(capacity_.begin(), capacity_.end(), [](int c) { return c > 0; }) < 2) return;
    scheduler_->worker_lost(static_cast<int>(worker));
    for (const Quantum& quantum : held_[worker]) lost_.insert(key_of(quantum));
    held_[worker].clear();
    capacity_[worker] = 0;
  }

  std::mt19937 random_;
  TileGrid grid_;
  std::vector<Level> levels_;
  std::vector<int> capacity_;
  std::optional<Scheduler> scheduler_;
  std::vector<std::vector<Quantum>> held_;
  std::set<Key> given_, done_, lost_;
};

TEST(Scheduler, KeepsItsLawsThroughAnyInterleavingAndLossOfWorkers) {
  for (unsigned seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    RandomRun(seed).run();
    if (HasFatalFailure()) return;
  }
}

struct Simulated {
  double makespan = 0;
  std::size_t quanta = 0;
  double busy = 0;
};

/// Workers of one thread each that take exactly as long as predicted; each holds `capacity`.
Simulated simulate(int workers, int capacity, const TileGrid& grid,
                   const std::vector<Level>& levels, const std::vector<int>& costs) {
  Scheduler scheduler(std::vector<int>(static_cast<std::size_t>(workers), capacity));
  scheduler.begin_view(grid, levels, history(grid, costs));
  std::vector<std::queue<Quantum>> held(static_cast<std::size_t>(workers));
  using Finish = std::pair<double, int>;
  std::priority_queue<Finish, std::vector<Finish>, std::greater<>> running;
  const auto cost_of = [&](const Quantum& quantum) { return costs[quantum.tile.value]; };
  const auto supply = [&](int worker, double now) {
    auto& queue = held[static_cast<std::size_t>(worker)];
    const bool idle = queue.empty();
    while (const auto quantum = scheduler.next(worker)) queue.push(*quantum);
    if (idle && !queue.empty()) running.push({now + cost_of(queue.front()), worker});
  };
  for (int w = 0; w < workers; ++w) supply(w, 0);
  Simulated result;
  while (!running.empty()) {
    const auto [now, worker] = running.top();
    running.pop();
    auto& queue = held[static_cast<std::size_t>(worker)];
    EXPECT_TRUE(scheduler.done(worker, queue.front().tile, queue.front().to));
    result.busy += cost_of(queue.front());
    queue.pop();
    if (!queue.empty()) running.push({now + cost_of(queue.front()), worker});
    supply(worker, now);
    result.makespan = now;
    ++result.quanta;
  }
  EXPECT_TRUE(scheduler.finished());
  return result;
}

/// The least makespan of all assignments, by trying each.
double optimum(std::vector<double>& loads, const std::vector<int>& costs, std::size_t at) {
  if (at == costs.size()) return *std::max_element(loads.begin(), loads.end());
  double best = std::numeric_limits<double>::infinity();
  std::set<double> tried;
  for (double& load : loads) {
    if (!tried.insert(load).second) continue;
    load += costs[at];
    best = std::min(best, optimum(loads, costs, at + 1));
    load -= costs[at];
  }
  return best;
}

TEST(Scheduler, IsWithinGrahamsBoundOfTheOptimum) {
  // R. L. Graham, Bounds on multiprocessing timing anomalies (1969): 4/3 − 1/(3m), longest first.
  std::mt19937 random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const int workers = std::uniform_int_distribution(2, 4)(random);
    const int tiles = std::uniform_int_distribution(1, 8)(random);
    const auto costs = random_costs(static_cast<std::size_t>(tiles), random);
    std::vector<double> loads(static_cast<std::size_t>(workers), 0);
    const double best = optimum(loads, costs, 0);
    const double got = simulate(workers, 1, row_of(tiles), direct_levels(), costs).makespan;
    EXPECT_LE(got, (4.0 / 3 - 1.0 / (3 * workers)) * best + 1e-9);
    EXPECT_GE(got, best - 1e-9);
  }
}

TEST(Scheduler, SuppliesFourThousandWorkers) {
  // An 8K picture in tiles of 32 pixels, and a cost that varies by three orders of magnitude.
  const TileGrid grid = TileGrid::squares({7680, 4320}, 32);
  std::mt19937 random(4);
  const auto costs = random_costs(grid.count(), random);
  constexpr int kWorkers = 4096;
  const auto levels = progressive_levels();
  const Simulated run = simulate(kWorkers, 2, grid, levels, costs);
  EXPECT_EQ(run.quanta, grid.count() * levels.size());
  // With one spare tile each, a worker ends at most two of the longest tiles after the mean.
  EXPECT_LE(run.makespan, run.busy / kWorkers + 2 * 1000);
}

}  // namespace
}  // namespace goldthread
