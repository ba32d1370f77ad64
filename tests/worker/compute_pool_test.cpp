// SPDX-License-Identifier: Apache-2.0
#include "worker/compute_pool.h"

#include <gtest/gtest.h>

#include <chrono>
#include <semaphore>
#include <set>
#include <stdexcept>
#include <thread>

#include "common/base/thread_clock.h"
#include "tests/worker/fake_source.h"
#include "worker/refine_tile.h"

namespace goldthread {
namespace {

const TileGrid kGrid = TileGrid::squares({256, 256}, 64);

std::shared_ptr<const CastView> view(std::uint32_t epoch,
                                     std::shared_ptr<const SampleSource> source) {
  const Refinement every_pixel{.sampling = Sampling::kEveryPixel};
  return std::make_shared<const CastView>(
      CastView{{epoch}, kGrid, every_pixel, {}, std::move(source)});
}

/// All pixels of a tile.
RenderTile tile(std::uint32_t epoch, std::uint32_t id) {
  return {{epoch}, {id}, kNoStep, kFirstAdaptiveStep};
}

/// What such a tile takes, and in how many batches.
struct WholeTile {
  WholeTile() {
    const auto source = std::make_shared<CountingSource>();
    rays = refine_tile(*view(1, source), tile(1, 0), nullptr, [] { return false; })->counts.rays;
    batches = source->batches;
  }
  std::uint64_t rays = 0;
  int batches = 0;
};
const WholeTile kWhole;

/// A pool whose notifications a test can wait for.
class NotifyingPool {
 public:
  explicit NotifyingPool(unsigned threads) : pool(threads, false, [this] { notified.release(); }) {}

  /// Waits until `count` quanta are done.
  std::vector<ComputePool::Done> take(std::size_t count) {
    std::vector<ComputePool::Done> all;
    while (all.size() < count) {
      notified.acquire();
      for (auto& done : pool.take_done()) all.push_back(std::move(done));
    }
    return all;
  }

  std::counting_semaphore<> notified{0};
  ComputePool pool;
};

TEST(ComputePool, CastsQuantaInOrderAndReportsThem) {
  NotifyingPool pool(1);
  pool.pool.begin_view(view(1, std::make_shared<CountingSource>()));
  for (std::uint32_t i = 0; i < 16; ++i) pool.pool.push(tile(1, 15 - i));
  const auto done = pool.take(16);
  ASSERT_EQ(done.size(), 16u);
  for (std::uint32_t i = 0; i < 16; ++i) {
    EXPECT_EQ(done[i].samples.tile, TileId{15 - i});
    EXPECT_EQ(done[i].report.tile, TileId{15 - i});
    EXPECT_EQ(done[i].report.epoch, Epoch{1});
    EXPECT_EQ(done[i].report.to, kFirstAdaptiveStep);
    EXPECT_EQ(done[i].report.rays, kWhole.rays);
    EXPECT_EQ(done[i].report.samples, 10 * kWhole.rays);
  }
  EXPECT_GE(kWhole.rays, 4096u);
  EXPECT_GT(pool.pool.busy_log(BusyLog::Clock::now()).total().count(), 0);
}

TEST(ComputePool, GoesOnWithTheTilesOfTheViewAndForgetsThoseOfOlderOnes) {
  NotifyingPool pool(1);
  for (std::uint32_t epoch = 1; epoch <= 2; ++epoch) {
    const auto source = std::make_shared<CountingSource>();
    pool.pool.begin_view(view(epoch, source));
    pool.pool.push({{epoch}, {0}, kNoStep, {1}});
    pool.take(1);
    EXPECT_EQ(source->batches, 1);
    pool.pool.push({{epoch}, {0}, {1}, {2}});
    EXPECT_EQ(pool.take(1).front().samples.count, 56u) << "of 9×9 places 25 were known";
    EXPECT_EQ(source->batches, 2) << "nothing was cast again";
  }
  const auto source = std::make_shared<CountingSource>();
  pool.pool.begin_view(view(3, source));
  pool.pool.push({{3}, {0}, {2}, {3}});
  const auto done = pool.take(1);
  EXPECT_EQ(source->batches, kWhole.batches) << "cast again from the first step";
  EXPECT_EQ(done.front().report.rays, kWhole.rays - 81) << "but told of once";
}

TEST(ComputePool, TellsOnceThatAViewHasBegun) {
  NotifyingPool pool(3);
  EXPECT_FALSE(pool.pool.take_begun());
  for (std::uint32_t epoch = 1; epoch <= 2; ++epoch) {
    pool.pool.begin_view(view(epoch, std::make_shared<CountingSource>()));
    EXPECT_FALSE(pool.pool.take_begun()) << "nothing of it has been begun";
    for (std::uint32_t i = 0; i < 6; ++i) pool.pool.push(tile(epoch, i));
    pool.take(6);
    EXPECT_EQ(pool.pool.take_begun(), Epoch{epoch});
    EXPECT_FALSE(pool.pool.take_begun());
  }
}

TEST(ComputePool, TellsThatAViewHasBegunBeforeItsFirstTileIsDone) {
  NotifyingPool pool(1);
  const auto held = std::make_shared<HeldSource>();
  pool.pool.begin_view(view(1, held));
  pool.pool.push(tile(1, 0));
  pool.notified.acquire();
  EXPECT_EQ(pool.pool.take_begun(), Epoch{1});
  EXPECT_TRUE(pool.pool.take_done().empty());
  held->allow(kWhole.batches);
  EXPECT_EQ(pool.take(1).size(), 1u);
}

TEST(ComputePool, AQuantumThatRunsCountsAsBusyUntilNow) {
  NotifyingPool pool(2);
  const auto held = std::make_shared<HeldSource>();
  pool.pool.begin_view(view(1, held));
  pool.pool.push(tile(1, 0));
  held->wait_until_entered(1);
  const auto now = BusyLog::Clock::now();
  const auto total = [&](BusyLog::Clock::time_point time) {
    return pool.pool.busy_log(time).total().count();
  };
  EXPECT_GT(total(now), 0);
  EXPECT_NEAR(total(now + std::chrono::seconds(3)), total(now) + 3, 1e-6) << "one thread, not two";
  held->allow(kWhole.batches);
  pool.take(1);
  EXPECT_EQ(total(now + std::chrono::seconds(60)), total(now + std::chrono::seconds(30)))
      << "it is over";
}

TEST(ComputePool, IgnoresQuantaWithoutOrOfAnotherView) {
  NotifyingPool pool(1);
  pool.pool.push(tile(1, 0));
  pool.pool.begin_view(view(2, std::make_shared<CountingSource>()));
  pool.pool.push(tile(1, 1));
  pool.pool.push(tile(3, 2));
  pool.pool.push(tile(2, 3));
  EXPECT_EQ(pool.take(1).front().samples.tile, TileId{3});
  EXPECT_TRUE(pool.pool.take_done().empty());
}

TEST(ComputePool, ANewerEpochEmptiesTheQueueAndStopsWhatRunsAtItsNextBatch) {
  NotifyingPool pool(1);
  const auto held = std::make_shared<HeldSource>();
  pool.pool.begin_view(view(1, held));
  for (std::uint32_t i = 0; i < 4; ++i) pool.pool.push(tile(1, i));
  held->wait_until_entered(1);
  pool.pool.begin_view(view(2, std::make_shared<CountingSource>()));
  held->allow(1000);
  pool.pool.push(tile(2, 9));
  const auto done = pool.take(1);
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done.front().samples.epoch, Epoch{2});
  EXPECT_EQ(held->batches, 1) << "of " << kWhole.batches << " in the first of four tiles";
}

TEST(ComputePool, NeverHandsOutWhatBecameStaleInTheOutbox) {
  NotifyingPool pool(1);
  pool.pool.begin_view(view(1, std::make_shared<CountingSource>()));
  pool.pool.push(tile(1, 0));
  pool.notified.acquire();  // it is begun
  pool.notified.acquire();  // it is done, and in the outbox
  pool.pool.begin_view(view(2, std::make_shared<CountingSource>()));
  EXPECT_TRUE(pool.pool.take_done().empty());
}

TEST(ComputePool, NeverHandsOutWhatBecameStaleInItsLastBatch) {
  NotifyingPool pool(1);
  const auto held = std::make_shared<HeldSource>();
  pool.pool.begin_view(view(1, held));
  pool.pool.push(tile(1, 0));
  held->allow(kWhole.batches - 1);
  held->wait_until_entered(kWhole.batches);
  pool.pool.begin_view(view(2, std::make_shared<CountingSource>()));
  held->allow(1);
  pool.pool.push(tile(2, 1));
  const auto done = pool.take(1);
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done.front().samples.epoch, Epoch{2});
  EXPECT_EQ(held->batches, kWhole.batches);
}

TEST(ComputePool, CastsOnAsManyThreadsAsItWasGiven) {
  constexpr int kThreads = 4;
  NotifyingPool pool(kThreads);
  const auto held = std::make_shared<HeldSource>();
  pool.pool.begin_view(view(1, held));
  for (std::uint32_t i = 0; i < kThreads; ++i) pool.pool.push(tile(1, i));
  held->wait_until_entered(kThreads);  // all at once: each is held in its first batch
  held->allow(kThreads * kWhole.batches);
  EXPECT_EQ(pool.take(kThreads).size(), 4u);
}

TEST(ComputePool, EndsWithQuantaInItsQueueAndLetsGoOfTheView) {
  const auto held = std::make_shared<HeldSource>();
  {
    NotifyingPool pool(2);
    pool.pool.begin_view(view(1, held));
    for (std::uint32_t i = 0; i < 16; ++i) pool.pool.push(tile(1, i));
    held->wait_until_entered(2);
    held->allow(16 * kWhole.batches);
  }
  EXPECT_EQ(held.use_count(), 1);
}

TEST(ComputePool, TellsOnceOfAThreadThatFailedAndGoesOn) {
  NotifyingPool pool(1);
  pool.pool.begin_view(view(1, std::make_shared<FailingSource>()));
  pool.pool.push(tile(1, 0));
  pool.notified.acquire();  // it is begun
  pool.notified.acquire();
  EXPECT_THROW(pool.pool.take_done(), std::runtime_error);
  EXPECT_TRUE(pool.pool.take_done().empty());
  pool.pool.begin_view(view(2, std::make_shared<CountingSource>()));
  pool.pool.push(tile(2, 0));
  EXPECT_EQ(pool.take(1).size(), 1u);
}

TEST(ComputePool, HoldsWhenViewsChangeWhileManyThreadsCast) {
  constexpr std::uint32_t kViews = 200;
  NotifyingPool pool(6);
  std::set<TileId> tiles;  // of the last view
  for (std::uint32_t epoch = 1; epoch <= kViews; ++epoch) {
    pool.pool.begin_view(view(epoch, std::make_shared<CountingSource>()));
    for (std::uint32_t i = 0; i < kGrid.count(); ++i) {
      pool.pool.push({{epoch}, {i}, kNoStep, {1}});
    }
    for (const auto& done : pool.pool.take_done()) {
      EXPECT_EQ(done.samples.epoch, Epoch{epoch});
      if (epoch == kViews) tiles.insert(done.samples.tile);
    }
  }
  while (tiles.size() < kGrid.count()) {
    pool.notified.acquire();
    for (const auto& done : pool.pool.take_done()) {
      EXPECT_EQ(done.samples.epoch, Epoch{kViews});
      tiles.insert(done.samples.tile);
    }
  }
}

/// Spends the same processor time on each batch, and sleeps as long as it is told to.
class SlowSource final : public CountingSource {
 public:
  SlowSource(std::chrono::milliseconds busy, std::chrono::milliseconds asleep)
      : busy_(busy), asleep_(asleep) {}
  CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                  std::span<std::uint32_t> surfaces) const override {
    std::this_thread::sleep_for(asleep_);
    const auto end = ThreadClock::now() + busy_;
    while (ThreadClock::now() < end) {
    }
    return CountingSource::cast(positions, samples, surfaces);
  }

 private:
  std::chrono::milliseconds busy_, asleep_;
};

TEST(ComputePool, TellsTheProcessorTimeOfATileNotThatOfTheClockOnTheWall) {
  NotifyingPool pool(1);
  using std::chrono::milliseconds;
  pool.pool.begin_view(view(1, std::make_shared<SlowSource>(milliseconds(5), milliseconds(0))));
  pool.pool.push({{1}, {0}, kNoStep, {1}});
  EXPECT_GE(pool.take(1).front().report.cost_us, 5000u) << "one batch";
  EXPECT_GE(pool.pool.busy_log(BusyLog::Clock::now()).total(), milliseconds(5));
  pool.pool.begin_view(view(2, std::make_shared<SlowSource>(milliseconds(0), milliseconds(50))));
  pool.pool.push({{2}, {0}, kNoStep, {1}});
  EXPECT_LT(pool.take(1).front().report.cost_us, 25000u) << "it slept for 50 ms";
}

}  // namespace
}  // namespace goldthread
