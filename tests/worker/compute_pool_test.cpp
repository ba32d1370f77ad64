// SPDX-License-Identifier: Apache-2.0
#include "worker/compute_pool.h"
#include "worker/cast_quantum.h"

#include <gtest/gtest.h>

#include <semaphore>
#include <set>
#include <stdexcept>

#include "tests/worker/fake_source.h"

namespace goldthread {
namespace {

const TileGrid kGrid = TileGrid::squares({256, 256}, 64);
/// Batches of a whole tile at the pixel level.
constexpr int kBatchesOfATile = 64 * 64 / int(kBatchRaysOfQuantum);

std::shared_ptr<const CastView> view(std::uint32_t epoch,
                                     std::shared_ptr<const SampleSource> source) {
  return std::make_shared<const CastView>(CastView{{epoch}, kGrid, std::move(source)});
}

RenderTile tile(std::uint32_t epoch, std::uint32_t id) {
  return {{epoch}, {id}, kNoLevel, kPixelLevel};
}

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
    EXPECT_EQ(done[i].report.to, kPixelLevel);
    EXPECT_EQ(done[i].report.rays, 4096u);
    EXPECT_EQ(done[i].report.samples, 40960u);
  }
  EXPECT_GT(pool.pool.busy().count(), 0);
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
  EXPECT_EQ(held->batches, 1) << "of " << kBatchesOfATile << " in the first of four tiles";
}

TEST(ComputePool, NeverHandsOutWhatBecameStaleInTheOutbox) {
  NotifyingPool pool(1);
  pool.pool.begin_view(view(1, std::make_shared<CountingSource>()));
  pool.pool.push(tile(1, 0));
  pool.notified.acquire();  // it is done, and in the outbox
  pool.pool.begin_view(view(2, std::make_shared<CountingSource>()));
  EXPECT_TRUE(pool.pool.take_done().empty());
}

TEST(ComputePool, NeverHandsOutWhatBecameStaleInItsLastBatch) {
  NotifyingPool pool(1);
  const auto held = std::make_shared<HeldSource>();
  pool.pool.begin_view(view(1, held));
  pool.pool.push(tile(1, 0));
  held->allow(kBatchesOfATile - 1);
  held->wait_until_entered(kBatchesOfATile);
  pool.pool.begin_view(view(2, std::make_shared<CountingSource>()));
  held->allow(1);
  pool.pool.push(tile(2, 1));
  const auto done = pool.take(1);
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done.front().samples.epoch, Epoch{2});
  EXPECT_EQ(held->batches, kBatchesOfATile);
}

TEST(ComputePool, CastsOnAsManyThreadsAsItWasGiven) {
  constexpr int kThreads = 4;
  NotifyingPool pool(kThreads);
  const auto held = std::make_shared<HeldSource>();
  pool.pool.begin_view(view(1, held));
  for (std::uint32_t i = 0; i < kThreads; ++i) pool.pool.push(tile(1, i));
  held->wait_until_entered(kThreads);  // all at once: each is held in its first batch
  held->allow(kThreads * kBatchesOfATile);
  EXPECT_EQ(pool.take(kThreads).size(), 4u);
}

TEST(ComputePool, EndsWithQuantaInItsQueueAndLetsGoOfTheView) {
  const auto held = std::make_shared<HeldSource>();
  {
    NotifyingPool pool(2);
    pool.pool.begin_view(view(1, held));
    for (std::uint32_t i = 0; i < 16; ++i) pool.pool.push(tile(1, i));
    held->wait_until_entered(2);
    held->allow(16 * kBatchesOfATile);
  }
  EXPECT_EQ(held.use_count(), 1);
}

TEST(ComputePool, TellsOnceOfAThreadThatFailedAndGoesOn) {
  NotifyingPool pool(1);
  pool.pool.begin_view(view(1, std::make_shared<FailingSource>()));
  pool.pool.push(tile(1, 0));
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
      pool.pool.push({{epoch}, {i}, kNoLevel, kCoarsestLevel});
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

}  // namespace
}  // namespace goldthread
