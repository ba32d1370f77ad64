// SPDX-License-Identifier: Apache-2.0
#include "master/scheduler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <queue>
#include <random>
#include <set>
#include <utility>

namespace goldthread {
namespace {

constexpr Step kFirst{1}, kSecond{2};

/// A grid of `tiles` equal tiles in one row.
TileGrid row_of(int tiles) { return TileGrid::squares({64 * tiles, 64}, 64); }

/// A history in which tile i took costs[i] µs for each of the first `steps` steps.
CostHistory history(const TileGrid& grid, const std::vector<int>& costs, int steps = 1) {
  CostHistory result;
  result.fit(grid);
  for (Step step{1}; step.value <= steps; step = step.next()) {
    for (std::uint32_t i = 0; i < costs.size(); ++i)
      result.record({i}, step, std::chrono::microseconds(costs[i]));
  }
  return result;
}

std::vector<int> random_costs(std::size_t count, std::mt19937& random) {
  std::vector<int> costs(count);
  for (int& cost : costs) cost = std::uniform_int_distribution(1, 1000)(random);
  return costs;
}

Scheduler begun(const std::vector<int>& capacity, const TileGrid& grid,
                const CostHistory& costs = {}) {
  Scheduler scheduler(capacity);
  scheduler.begin_view(grid, costs);
  return scheduler;
}

/// All that `worker` is given now.
std::vector<std::uint32_t> taken_by(Scheduler& scheduler, int worker) {
  std::vector<std::uint32_t> tiles;
  while (const auto quantum = scheduler.next(worker)) tiles.push_back(quantum->tile.value);
  return tiles;
}

void finish(Scheduler& scheduler, int worker, const std::vector<std::uint32_t>& tiles,
            double squared_error = 1) {
  for (const std::uint32_t tile : tiles)
    ASSERT_EQ(Finished::kFirst, scheduler.done(worker, {tile}, scheduler.step(), squared_error));
}

/// All that `worker` is given until there is nothing left for it, each finished before the next.
std::vector<std::uint32_t> worked_off_by(Scheduler& scheduler, int worker) {
  std::vector<std::uint32_t> tiles;
  while (const auto quantum = scheduler.next(worker)) {
    tiles.push_back(quantum->tile.value);
    EXPECT_EQ(Finished::kFirst, scheduler.done(worker, quantum->tile, quantum->to, 1));
  }
  return tiles;
}

using Tiles = std::vector<std::uint32_t>;

TEST(Scheduler, GivesOutDescendingPredictedCostAtTheFirstStep) {
  std::mt19937 random(1);
  const TileGrid grid = row_of(50);
  const CostHistory costs = history(grid, random_costs(grid.count(), random));
  Scheduler scheduler = begun({1000}, grid, costs);
  EXPECT_EQ(scheduler.step(), kFirst);
  double before = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < grid.count(); ++i) {
    const auto quantum = scheduler.next(0);
    ASSERT_TRUE(quantum);
    EXPECT_EQ(quantum->from, kNoStep);
    EXPECT_EQ(quantum->to, kFirst);
    const double cost = costs.predict_us(quantum->tile, kFirst);
    EXPECT_LE(cost, before);
    before = cost;
  }
  EXPECT_FALSE(scheduler.next(0));
}

TEST(Scheduler, KeepsTheOrderOfTilesThatCostTheSame) {
  Scheduler scheduler = begun({100}, row_of(20));
  for (std::uint32_t i = 0; i < 20; ++i) EXPECT_EQ(scheduler.next(0)->tile, TileId{i});
}

TEST(Scheduler, GivesOutDescendingErrorPerCostAtLaterSteps) {
  std::mt19937 random(2);
  const TileGrid grid = row_of(50);
  const CostHistory costs = history(grid, random_costs(grid.count(), random), 2);
  std::vector<double> errors;
  for (const int error : random_costs(grid.count(), random)) errors.push_back(error);
  Scheduler scheduler = begun({1000}, grid, costs);
  for (Step step = kFirst; step <= Step{4}; step = step.next()) {
    double before = std::numeric_limits<double>::infinity();
    for (const std::uint32_t tile : taken_by(scheduler, 0)) {
      if (step > kFirst) {
        const double urgency = errors[tile] / costs.predict_us({tile}, step);
        EXPECT_LE(urgency, before);
        before = urgency;
      }
      // The next step goes by what this one has left.
      errors[tile] = step == kFirst ? errors[tile] : errors[tile] / (1 + tile % 7);
      ASSERT_EQ(Finished::kFirst, scheduler.done(0, {tile}, step, errors[tile]));
    }
    ASSERT_TRUE(scheduler.finished());
    scheduler.open_step(costs);
  }
}

TEST(Scheduler, OpensEachStepWithAllTilesAndCountsThemDone) {
  Scheduler scheduler = begun({100}, row_of(3));
  for (Step step = kFirst; step <= Step{5}; step = step.next()) {
    EXPECT_EQ(scheduler.step(), step);
    for (std::size_t open = 3; open > 0; --open) {
      EXPECT_EQ(scheduler.open(), open);
      EXPECT_FALSE(scheduler.finished());
      const auto quantum = scheduler.next(0);
      ASSERT_TRUE(quantum);
      EXPECT_EQ(quantum->from.next(), step);
      EXPECT_EQ(quantum->to, step);
      ASSERT_EQ(Finished::kFirst, scheduler.done(0, quantum->tile, quantum->to, 1));
    }
    EXPECT_TRUE(scheduler.finished());
    EXPECT_FALSE(scheduler.next(0)) << "the next step is not open yet";
    scheduler.open_step({});
  }
}

TEST(Scheduler, GivesAWorkerNoMoreThanItsCapacity) {
  Scheduler scheduler = begun({2, 0, 3}, row_of(10));
  EXPECT_TRUE(scheduler.next(0));
  const auto second = scheduler.next(0);
  EXPECT_TRUE(second);
  EXPECT_FALSE(scheduler.next(0));
  EXPECT_FALSE(scheduler.next(1));
  EXPECT_EQ(Finished::kFirst, scheduler.done(0, second->tile, second->to, 1));
  EXPECT_TRUE(scheduler.next(0));
  EXPECT_FALSE(scheduler.next(0));
}

TEST(Scheduler, IgnoresWhatAWorkerDoesNotHold) {
  Scheduler scheduler = begun({2, 2}, row_of(4));
  const Quantum held = *scheduler.next(0);
  EXPECT_EQ(Finished::kNot, scheduler.done(1, held.tile, held.to, 1)) << "another worker's";
  EXPECT_EQ(Finished::kNot, scheduler.done(0, held.tile, kSecond, 1)) << "another step";
  EXPECT_EQ(Finished::kNot, scheduler.done(0, held.tile, kNoStep, 1)) << "no step";
  EXPECT_EQ(Finished::kNot, scheduler.done(0, {99}, held.to, 1)) << "no such tile";
  EXPECT_EQ(scheduler.open(), 4u);
  EXPECT_EQ(Finished::kFirst, scheduler.done(0, held.tile, held.to, 1));
  EXPECT_EQ(Finished::kNot, scheduler.done(0, held.tile, held.to, 1)) << "a second time";
  EXPECT_EQ(scheduler.open(), 3u);
}

TEST(Scheduler, ForgetsTheOldViewWhenANewOneBegins) {
  Scheduler scheduler = begun({3, 3}, row_of(4));
  const Quantum old = *scheduler.next(0);
  scheduler.begin_view(row_of(2), {});
  EXPECT_EQ(scheduler.step(), kFirst);
  EXPECT_EQ(scheduler.open(), 2u);
  EXPECT_EQ(Finished::kNot, scheduler.done(0, old.tile, old.to, 1))
      << "in flight from the old view";
  EXPECT_EQ(taken_by(scheduler, 1), (Tiles{0, 1})) << "and nobody's any more";
}

TEST(Scheduler, GivesOutNothingWithoutAViewOrOfOneThatIsCancelled) {
  Scheduler scheduler({3});
  EXPECT_TRUE(scheduler.finished());
  EXPECT_FALSE(scheduler.next(0));
  scheduler.begin_view(row_of(9), {});
  finish(scheduler, 0, taken_by(scheduler, 0));
  const Quantum held = *scheduler.next(0);
  scheduler.cancel();
  EXPECT_TRUE(scheduler.finished());
  EXPECT_FALSE(scheduler.next(0));
  EXPECT_EQ(Finished::kNot, scheduler.done(0, held.tile, held.to, 1));
}

TEST(Scheduler, LeavesATileWithTheWorkerThatHoldsItsState) {
  Scheduler scheduler = begun({3, 2}, row_of(5));
  finish(scheduler, 1, taken_by(scheduler, 1));
  finish(scheduler, 0, taken_by(scheduler, 0));
  for (Step step = kSecond; step <= Step{4}; step = step.next()) {
    scheduler.open_step({});
    EXPECT_EQ(taken_by(scheduler, 0), (Tiles{2, 3, 4}));
    EXPECT_EQ(taken_by(scheduler, 1), (Tiles{0, 1}));
    finish(scheduler, 0, {2, 3, 4});
    finish(scheduler, 1, {0, 1});
  }
}

/// Worker 0, of one thread and a spare place, holds ten tiles at the second step; worker 1 none.
Scheduler unbalanced(const CostHistory& costs) {
  Scheduler scheduler = begun({2, 2}, row_of(10), costs);
  worked_off_by(scheduler, 0);
  scheduler.open_step(costs);
  return scheduler;
}

TEST(Scheduler, LetsAnIdleWorkerTakeOverWhereItIsQuickerThanWaiting) {
  // Each step of a tile costs 100 µs: a newcomer takes 200 µs. That is less than the owner needs
  // for more than two of its ten tiles.
  Scheduler scheduler = unbalanced(history(row_of(10), std::vector(10, 100), 2));
  EXPECT_EQ(worked_off_by(scheduler, 1), (Tiles{9, 8, 7, 6, 5, 4, 3, 2})) << "the least urgent";
  EXPECT_EQ(worked_off_by(scheduler, 0), (Tiles{0, 1}));
  EXPECT_TRUE(scheduler.finished());
}

TEST(Scheduler, LeavesATileThatWouldTakeLongerToCastAgainThanToWaitFor) {
  CostHistory costs = history(row_of(10), std::vector(10, 1000));
  for (std::uint32_t i = 0; i < 10; ++i) costs.record({i}, kSecond, std::chrono::microseconds(100));
  Scheduler scheduler = unbalanced(costs);
  EXPECT_FALSE(scheduler.next(1)) << "1100 µs instead of 1000";
  EXPECT_EQ(worked_off_by(scheduler, 0).size(), 10u);
}

TEST(Scheduler, LeavesATakenOverTileWithItsNewOwner) {
  const CostHistory costs = history(row_of(10), std::vector(10, 100), 2);
  Scheduler scheduler = unbalanced(costs);
  const Tiles taken = taken_by(scheduler, 1);
  EXPECT_EQ(taken, (Tiles{9, 8}));
  finish(scheduler, 1, taken);
  worked_off_by(scheduler, 0);
  scheduler.open_step(costs);
  Tiles again = worked_off_by(scheduler, 1);
  ASSERT_GE(again.size(), 2u);
  again.resize(2);
  EXPECT_EQ(again, (Tiles{8, 9})) << "before it takes over others";
}

TEST(Scheduler, CountsOwnersThreadsWhereItCompares) {
  // Of eight threads a tile of ten is waited for a quarter of a step: quicker than any newcomer.
  const CostHistory costs = history(row_of(10), std::vector(10, 100), 2);
  Scheduler scheduler = begun({9, 2}, row_of(10), costs);
  worked_off_by(scheduler, 0);
  scheduler.open_step(costs);
  EXPECT_FALSE(scheduler.next(1));
}

TEST(Scheduler, HoldsASpareBackAtTheEndOfAStep) {
  const TileGrid grid = row_of(10);
  const CostHistory costs = history(grid, std::vector(10, 1000));
  // Four threads: a spare of 1000 µs is due while 8000 wait.
  Scheduler scheduler = begun({2, 2, 2, 2}, grid, costs);
  EXPECT_EQ(taken_by(scheduler, 0), (Tiles{0, 1})) << "9000 wait";
  EXPECT_EQ(taken_by(scheduler, 1), (Tiles{2})) << "7000 wait";
  EXPECT_EQ(taken_by(scheduler, 2), (Tiles{3}));
  finish(scheduler, 1, {2});
  EXPECT_EQ(taken_by(scheduler, 1), (Tiles{4})) << "no thread is left idle";
  finish(scheduler, 0, {0});
  EXPECT_EQ(taken_by(scheduler, 0), Tiles{}) << "it has its spare";
}

TEST(Scheduler, HoldsNoSpareBackThatNobodyWouldTakeOver) {
  // Another worker would have to cast the first step again: a trifle, or five times the second.
  const TileGrid grid = row_of(2);
  for (const int first_us : {100, 5000}) {
    CostHistory costs = history(grid, {first_us, first_us});
    for (std::uint32_t i = 0; i < 2; ++i)
      costs.record({i}, kSecond, std::chrono::microseconds(1000));
    Scheduler scheduler = begun({2, 2}, grid, costs);
    worked_off_by(scheduler, 0);
    scheduler.open_step(costs);
    EXPECT_EQ(taken_by(scheduler, 0).size(), first_us == 100 ? 1u : 2u);
  }
}

TEST(Scheduler, DealsTilesByWhatAllTheirStepsWillTake) {
  // In the first step all are alike; in all of them the first four take as long as all others.
  const TileGrid grid = row_of(28);
  CostHistory costs = history(grid, std::vector(28, 10));
  for (std::uint32_t i = 0; i < 28; ++i)
    costs.record({i}, kSecond, std::chrono::microseconds(i < 4 ? 5990 : 990));
  Scheduler scheduler({2, 3});
  scheduler.begin_view(grid, costs, kSecond);
  std::vector<double> us;
  for (const int worker : {0, 1}) {
    double sum = 0;
    for (const std::uint32_t tile : worked_off_by(scheduler, worker)) sum += tile < 4 ? 6000 : 1000;
    us.push_back(sum);
  }
  EXPECT_EQ(us[0], 16000) << "one thread of three";
  EXPECT_EQ(us[1], 32000);
}

TEST(Scheduler, DealsNotOneWorkerAllThatIsForNothing) {
  const TileGrid grid = row_of(12);
  Scheduler scheduler({2, 2, 2});
  scheduler.begin_view(grid, history(grid, std::vector(12, 0), 2), kSecond);
  for (const int worker : {0, 1, 2}) EXPECT_EQ(worked_off_by(scheduler, worker).size(), 4u);
}

TEST(Scheduler, TakesOverWhatLetsBothEndSoonest) {
  // Worker 0 holds all tiles; their first step took nothing to speak of.
  const TileGrid grid = row_of(5);
  CostHistory costs = history(grid, std::vector(5, 1));
  const std::vector<int> second{100, 700, 300, 200, 400};
  for (std::uint32_t i = 0; i < 5; ++i)
    costs.record({i}, kSecond, std::chrono::microseconds(second[i]));
  Scheduler scheduler = begun({2, 2}, grid, costs);
  worked_off_by(scheduler, 0);
  scheduler.open_step(costs);
  // 1700 µs wait: max(1700 − c, c + 1) is least for c = 700.
  EXPECT_EQ(scheduler.next(1)->tile, TileId{1});
  finish(scheduler, 1, {1});
  // Now 1000: for c = 400.
  EXPECT_EQ(scheduler.next(1)->tile, TileId{4});
}

TEST(Scheduler, GivesALostWorkersTilesOutAgainFirstAndOnce) {
  Scheduler scheduler = begun({3, 100}, row_of(10));
  const Tiles lost = taken_by(scheduler, 0);
  ASSERT_EQ(lost.size(), 3u);
  ASSERT_TRUE(scheduler.next(1));
  scheduler.worker_lost(0);
  EXPECT_FALSE(scheduler.next(0)) << "the dead get nothing";
  EXPECT_EQ(Finished::kNot, scheduler.done(0, {lost[0]}, kFirst, 1))
      << "nor does what they send count";
  EXPECT_EQ(taken_by(scheduler, 1), (Tiles{0, 1, 2, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(scheduler.open(), 10u);
}

TEST(Scheduler, GivesOutWhatALostWorkerHeldBeforeWhatWaitedForIt) {
  Scheduler scheduler = begun({2, 9}, row_of(6));
  worked_off_by(scheduler, 0);
  scheduler.open_step({});
  ASSERT_EQ(taken_by(scheduler, 0), (Tiles{0, 1}));
  EXPECT_FALSE(scheduler.next(1)) << "of unknown cost";
  scheduler.worker_lost(0);
  EXPECT_EQ(taken_by(scheduler, 1), (Tiles{0, 1, 2, 3, 4, 5}));
}

TEST(Scheduler, HasWhatALostWorkerDidOfTheOpenStepDoneAgain) {
  Scheduler scheduler = begun({3, 6}, row_of(7));
  const Tiles own = taken_by(scheduler, 0);
  finish(scheduler, 0, {own[0], own[1]});
  EXPECT_EQ(scheduler.open(), 5u);
  scheduler.worker_lost(0);
  EXPECT_EQ(scheduler.open(), 7u) << "its samples may not have arrived";
  EXPECT_EQ(taken_by(scheduler, 1), (Tiles{2, 0, 1, 3, 4, 5})) << "after what it held";
  EXPECT_EQ(Finished::kAgain, scheduler.done(1, {0}, kFirst, 1));
  EXPECT_EQ(Finished::kFirst, scheduler.done(1, {2}, kFirst, 1));
}

TEST(Scheduler, ForgetsThatALostWorkerHeldTheStateOfATile) {
  Scheduler scheduler = begun({3, 3}, row_of(6));
  const Tiles own = taken_by(scheduler, 0), others = taken_by(scheduler, 1);
  finish(scheduler, 0, own);
  finish(scheduler, 1, others);
  scheduler.worker_lost(0);
  EXPECT_TRUE(scheduler.finished()) << "a step that was finished remains so";
  scheduler.open_step({});
  EXPECT_EQ(worked_off_by(scheduler, 1).size(), 6u);
}

TEST(Scheduler, DoesNotBringALostWorkerBackWithTheNextView) {
  Scheduler scheduler = begun({3, 3}, row_of(4));
  scheduler.worker_lost(0);
  scheduler.begin_view(row_of(4), {});
  EXPECT_FALSE(scheduler.next(0));
  EXPECT_TRUE(scheduler.next(1));
}

/// Drives a scheduler through a random interleaving of several steps and checks its laws.
class RandomRun {
 public:
  explicit RandomRun(unsigned seed) : random_(seed) {
    const int workers = uniform(1, 6);
    for (int w = 0; w < workers; ++w) capacity_.push_back(uniform(1, 4));
    held_.resize(capacity_.size());
    grid_ = TileGrid::squares({uniform(1, 300), uniform(1, 300)}, 64);
    owner_.assign(grid_.count(), -1);
    costs_ = history(grid_, random_costs(grid_.count(), random_), uniform(0, kSteps));
    scheduler_.emplace(capacity_);
    scheduler_->begin_view(grid_, costs_);
  }

  void run() {
    for (int step = 1; step <= kSteps; ++step) {
      run_step();
      if (::testing::Test::HasFatalFailure()) return;
      ASSERT_EQ(done_.size(), grid_.count()) << "step " << step;
      if (step < kSteps) scheduler_->open_step(costs_);
      done_.clear();
      given_.clear();
      again_.clear();
    }
  }

 private:
  static constexpr int kSteps = 6;

  int uniform(int first, int last) { return std::uniform_int_distribution(first, last)(random_); }

  void run_step() {
    while (!scheduler_->finished() && !::testing::Test::HasFatalFailure()) {
      const auto worker = static_cast<std::size_t>(uniform(0, int(capacity_.size()) - 1));
      const int dice = uniform(0, 99);
      if (dice < 1)
        lose(worker);
      else if (dice < 10)
        lie(worker);
      else if (dice < 55)
        give(worker);
      else
        finish(worker);
    }
  }
  void give(std::size_t worker) {
    const bool room = std::cmp_less(held_[worker].size(), capacity_[worker]);
    // A spare may be held back, a thread may not.
    const bool idle = std::cmp_less(held_[worker].size(), std::max(1, capacity_[worker] - 1));
    const bool own = any_open([&](int owner) { return owner == int(worker); });
    const bool free = any_open([&](int owner) { return owner < 0; });
    const auto quantum = scheduler_->next(static_cast<int>(worker));
    if (!quantum) {
      ASSERT_FALSE(room && idle && (own || free)) << "idle while there is work";
      return;
    }
    ASSERT_TRUE(room);
    const std::uint32_t tile = quantum->tile.value;
    ASSERT_EQ(quantum->to, scheduler_->step());
    ASSERT_EQ(quantum->from.next(), quantum->to);
    ASSERT_TRUE(given_.insert(tile).second) << "given out twice";
    ASSERT_FALSE(done_.contains(tile));
    if (owner_[tile] != int(worker)) {
      ASSERT_FALSE(own) << "its own tiles come first";
    }
    if (owner_[tile] >= 0 && owner_[tile] != int(worker)) {
      ASSERT_FALSE(free) << "nobody's tiles come before another's";
    }
    owner_[tile] = static_cast<int>(worker);
    held_[worker].push_back(*quantum);
  }
  /// Whether there is a tile that nobody holds or has done, of such an owner.
  template <class Predicate>
  bool any_open(Predicate of_owner) const {
    for (std::uint32_t tile = 0; tile < grid_.count(); ++tile) {
      if (!given_.contains(tile) && of_owner(owner_[tile])) return true;
    }
    return false;
  }
  void finish(std::size_t worker) {
    if (held_[worker].empty()) return;
    const auto at = static_cast<std::size_t>(uniform(0, int(held_[worker].size()) - 1));
    const Quantum quantum = held_[worker][at];
    held_[worker].erase(held_[worker].begin() + std::ptrdiff_t(at));
    const std::uint32_t tile = quantum.tile.value;
    ASSERT_EQ(
        again_.contains(tile) ? Finished::kAgain : Finished::kFirst,
        scheduler_->done(static_cast<int>(worker), quantum.tile, quantum.to, uniform(0, 1000)));
    ASSERT_TRUE(done_.insert({tile, static_cast<int>(worker)}).second) << "done twice";
    ASSERT_EQ(scheduler_->open(), grid_.count() - done_.size());
  }
  void lie(std::size_t worker) {
    const TileId tile{static_cast<std::uint32_t>(uniform(0, int(grid_.count())))};
    const Step step{static_cast<std::uint16_t>(uniform(0, kSteps + 1))};
    for (const Quantum& quantum : held_[worker]) {
      if (quantum.tile == tile && quantum.to == step) return;
    }
    ASSERT_EQ(Finished::kNot, scheduler_->done(static_cast<int>(worker), tile, step, 0));
  }
  void lose(std::size_t worker) {
    if (std::count_if(capacity_.begin(), capacity_.end(), [](int c) { return c > 0; }) < 2) return;
    scheduler_->worker_lost(static_cast<int>(worker));
    for (const Quantum& quantum : held_[worker]) given_.erase(quantum.tile.value);
    held_[worker].clear();
    capacity_[worker] = 0;
    for (auto done = done_.begin(); done != done_.end();) {
      if (done->second != static_cast<int>(worker)) {
        ++done;
        continue;
      }
      again_.insert(done->first);
      given_.erase(done->first);
      done = done_.erase(done);
    }
    std::replace(owner_.begin(), owner_.end(), static_cast<int>(worker), -1);
  }

  std::mt19937 random_;
  TileGrid grid_;
  CostHistory costs_;
  std::vector<int> capacity_;
  std::optional<Scheduler> scheduler_;
  std::vector<std::vector<Quantum>> held_;
  std::vector<int> owner_;             ///< of each tile's state
  std::set<std::uint32_t> given_;      ///< of the open step
  std::map<std::uint32_t, int> done_;  ///< of those which, and by whom
  std::set<std::uint32_t> again_;      ///< that a lost worker had done
};

TEST(Scheduler, TakesEachTileThroughEachStepOnceInAnyInterleavingAndLossOfWorkers) {
  for (unsigned seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    RandomRun(seed).run();
    if (HasFatalFailure()) return;
  }
}

/// Workers of one thread each that take exactly as long as predicted; each holds `capacity`.
class Simulation {
 public:
  Simulation(int workers, int capacity, const TileGrid& grid, std::vector<int> costs)
      : grid_(grid),
        costs_(std::move(costs)),
        scheduler_(std::vector<int>(static_cast<std::size_t>(workers), capacity)),
        held_(static_cast<std::size_t>(workers)),
        owner_(grid.count(), -1) {
    scheduler_.begin_view(grid_, history(grid_, costs_));
  }
  /// From its begin until its last tile is done.
  double run_step() {
    if (scheduler_.finished()) scheduler_.open_step(history(grid_, costs_));
    double now = 0;
    for (std::size_t w = 0; w < held_.size(); ++w) supply(w, 0);
    while (!running_.empty()) {
      const auto [end, worker] = running_.top();
      running_.pop();
      now = end;
      auto& queue = held_[worker];
      const Quantum quantum = queue.front().first;
      EXPECT_EQ(Finished::kFirst,
                scheduler_.done(static_cast<int>(worker), quantum.tile, quantum.to, 1));
      queue.pop();
      if (!queue.empty()) running_.push({now + queue.front().second, worker});
      supply(worker, now);
    }
    EXPECT_TRUE(scheduler_.finished());
    return now;
  }

 private:
  using Finish = std::pair<double, std::size_t>;

  void supply(std::size_t worker, double now) {
    auto& queue = held_[worker];
    const bool idle = queue.empty();
    while (const auto quantum = scheduler_.next(static_cast<int>(worker))) {
      int& owner = owner_[quantum->tile.value];
      const int steps = std::cmp_equal(owner, worker) ? 1 : quantum->to.value;
      owner = static_cast<int>(worker);
      queue.push({*quantum, double(steps) * costs_[quantum->tile.value]});
    }
    if (idle && !queue.empty()) running_.push({now + queue.front().second, worker});
  }

  TileGrid grid_;
  std::vector<int> costs_;  ///< of any step
  Scheduler scheduler_;
  std::vector<std::queue<std::pair<Quantum, double>>> held_;  ///< with what each costs
  std::vector<int> owner_;
  std::priority_queue<Finish, std::vector<Finish>, std::greater<>> running_;
};

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

TEST(Scheduler, IsWithinGrahamsBoundOfTheOptimumAtTheFirstStep) {
  // R. L. Graham, Bounds on multiprocessing timing anomalies (1969): 4/3 − 1/(3m), longest first.
  std::mt19937 random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const int workers = std::uniform_int_distribution(2, 4)(random);
    const int tiles = std::uniform_int_distribution(1, 8)(random);
    const auto costs = random_costs(static_cast<std::size_t>(tiles), random);
    std::vector<double> loads(static_cast<std::size_t>(workers), 0);
    const double best = optimum(loads, costs, 0);
    const double got = Simulation(workers, 1, row_of(tiles), costs).run_step();
    EXPECT_LE(got, (4.0 / 3 - 1.0 / (3 * workers)) * best + 1e-9);
    EXPECT_GE(got, best - 1e-9);
  }
}

TEST(Scheduler, SuppliesFourThousandWorkers) {
  // An 8K picture in tiles of 32 pixels, and a cost that varies by three orders of magnitude.
  const TileGrid grid = TileGrid::squares({7680, 4320}, 32);
  std::mt19937 random(4);
  const auto costs = random_costs(grid.count(), random);
  const double all = std::accumulate(costs.begin(), costs.end(), 0.0);
  constexpr int kWorkers = 4096;
  Simulation simulation(kWorkers, 2, grid, costs);
  // With one spare tile each, a worker ends at most two of the longest tiles after the mean; and
  // later steps leave each with what it has.
  for (int step = 1; step <= 3; ++step)
    EXPECT_LE(simulation.run_step(), all / kWorkers + 2 * 1000) << "step " << step;
}

}  // namespace
}  // namespace goldthread
