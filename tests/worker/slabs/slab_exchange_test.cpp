// SPDX-License-Identifier: Apache-2.0
// Waiting for rays that others take through their slabs.

#include "worker/slabs/slab_exchange.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <future>
#include <semaphore>

#include "worker/slabs/ray_messages.h"
#include "worker/slabs/ray_pool.h"

namespace goldthread {
namespace {

constexpr Epoch kEpoch{5};

/// Adds its slab's number to what rays have gathered.
class AddingCaster final : public SlabCaster {
 public:
  explicit AddingCaster(float number) : number_(number) {}
  CastCounts advance(const RaySpan& rays, Stage) const override {
    for (Sample& sample : rays.samples) sample.red += number_;
    return {rays.positions.size(), 10 * rays.positions.size()};
  }
  bool has_surfaces() const override { return false; }
  bool seeks_greatest() const override { return false; }

 private:
  float number_;
};

RayBatch batch_with(float red, std::size_t rays = 3) {
  RayBatch batch{
      kGather, std::vector<PixelPosition>(rays), std::vector<Sample>(rays, {red, 0, 0, 0}), {}};
  return batch;
}

/// The exchange of worker 0 of 5 workers with 2 slabs; a thread asks, the test answers.
struct SlabExchangeTest : testing::Test {
  std::counting_semaphore<100> told{0};
  std::counting_semaphore<> cores{1};
  SlabExchange exchange{0, 5, 2, cores, [this] { told.release(); }};
  std::shared_ptr<const SlabLink> link;

  SlabExchangeTest() {
    exchange.begin_view(kEpoch);
    link = exchange.link(kEpoch, std::make_shared<AddingCaster>(1.0F));
  }
  std::future<bool> ask(RayBatch& batch, int slab = 1) {
    return std::async(std::launch::async,
                      [this, &batch, slab] { return link->advance(slab, batch); });
  }
  /// The next requests that are to be sent.
  std::vector<SlabExchange::Request> requests(std::size_t count = 1) {
    std::vector<SlabExchange::Request> all;
    while (all.size() < count) {
      told.acquire();
      for (auto& request : exchange.take_requests()) all.push_back(std::move(request));
    }
    return all;
  }
  static RaysAdvanced answer_to(const SlabExchange::Request& request, float add) {
    auto batch = batch_of(request.message, false);
    for (Sample& sample : batch->samples) sample.red += add;
    batch->taken = 7;
    return answer_of(*batch, request.message.epoch, request.message.job);
  }
};

TEST_F(SlabExchangeTest, TheOwnSlabNeedsNoMessage) {
  RayBatch batch = batch_with(2);
  EXPECT_TRUE(link->advance(0, batch));
  EXPECT_EQ(batch.samples[0].red, 3);
  EXPECT_EQ(batch.taken, 30U);
  EXPECT_TRUE(exchange.take_requests().empty());
}

TEST_F(SlabExchangeTest, AnAnswerEndsTheWaitingWhateverTheirOrder) {
  RayBatch a = batch_with(10), b = batch_with(20);
  auto first = ask(a);
  auto second = ask(b);
  auto both = requests(2);
  for (const auto& request : both) EXPECT_EQ(request.worker % 2, 1);
  std::reverse(both.begin(), both.end());
  for (const auto& request : both) EXPECT_TRUE(exchange.complete(answer_to(request, 0.5F)));
  EXPECT_TRUE(first.get());
  EXPECT_TRUE(second.get());
  EXPECT_EQ(a.samples[2].red, 10.5F);
  EXPECT_EQ(b.samples[0].red, 20.5F);
  EXPECT_EQ(a.taken, 7U);
}

TEST_F(SlabExchangeTest, ANewViewEndsTheWaitingInVain) {
  RayBatch batch = batch_with(1);
  auto asked = ask(batch);
  const auto request = requests();
  exchange.begin_view({kEpoch.value + 1});
  EXPECT_FALSE(asked.get());
  EXPECT_TRUE(exchange.complete(answer_to(request[0], 1)));  // too late: ignored
  EXPECT_EQ(batch.samples[0].red, 1);
  EXPECT_FALSE(link->advance(1, batch));
}

TEST_F(SlabExchangeTest, StoppingEndsAllWaiting) {
  RayBatch batch = batch_with(1);
  auto asked = ask(batch);
  requests();
  exchange.stop();
  EXPECT_FALSE(asked.get());
}

TEST_F(SlabExchangeTest, WhatALostWorkerWasAskedIsAskedOfAnotherWithItsSlab) {
  RayBatch batch = batch_with(1);
  auto asked = ask(batch);
  const auto request = requests();
  EXPECT_TRUE(exchange.worker_gone(request[0].worker));
  const auto again = requests();
  EXPECT_EQ(again[0].worker, request[0].worker == 1 ? 3 : 1);
  EXPECT_TRUE(exchange.complete(answer_to(again[0], 2)));
  EXPECT_TRUE(asked.get());
  EXPECT_EQ(batch.samples[0].red, 3);
  EXPECT_TRUE(exchange.complete(answer_to(request[0], 5)));  // it was not dead after all
  EXPECT_EQ(batch.samples[0].red, 3);
  EXPECT_FALSE(exchange.worker_gone(again[0].worker)) << "the last one with slab 1";
}

TEST_F(SlabExchangeTest, AnAnswerThatDoesNotFitIsRefused) {
  RayBatch batch = batch_with(1);
  auto asked = ask(batch);
  const auto request = requests();
  RaysAdvanced short_answer = answer_to(request[0], 1);
  short_answer.packed.truncate(short_answer.packed.size() - 1);
  EXPECT_FALSE(exchange.complete(short_answer));
  EXPECT_TRUE(exchange.complete(answer_to(request[0], 1)));
  EXPECT_TRUE(asked.get());
}

TEST(RayMessages, BytesThatAreNoRaysAreRefused) {
  const RayBatch batch = batch_with(3, 4);
  AdvanceRays request = request_of(batch, kEpoch, 1);
  EXPECT_TRUE(batch_of(request, false));
  EXPECT_FALSE(batch_of(request, true));
  request.count = 5;
  EXPECT_FALSE(batch_of(request, false));
  request.count = 0xFFFFFFFF;
  EXPECT_FALSE(batch_of(request, false));
}

TEST(RayMessages, RaysComeThroughAsTheyWere) {
  RayBatch batch{kComplete, {{1, 2}, {3, 4}}, {{1, 2, 3, 4}, {5, 6, 7, 8}}, {9, 10}};
  const auto read = batch_of(request_of(batch, kEpoch, 3), true);
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->stage.completes);
  EXPECT_FALSE(read->stage.marches);
  EXPECT_EQ(read->positions[1].y, 4);
  EXPECT_EQ(read->samples, batch.samples);
  EXPECT_EQ(read->surfaces, batch.surfaces);
}

struct RayPoolTest : testing::Test {
  std::counting_semaphore<100> told{0};
  std::counting_semaphore<> cores{1};
  RayPool pool{2, false, cores, [this] { told.release(); }};
  RayPool::Done done() {
    told.acquire();
    auto all = pool.take_done();
    EXPECT_EQ(all.size(), 1U);
    return std::move(all.at(0));
  }
  void push(Epoch epoch, float red) { pool.push({7}, request_of(batch_with(red), epoch, 1)); }
};

TEST_F(RayPoolTest, RaysThatOvertookTheirViewWaitForIt) {
  push(kEpoch, 3);
  push({kEpoch.value - 1}, 4);
  EXPECT_TRUE(pool.take_done().empty());
  pool.begin_view(kEpoch, std::make_shared<AddingCaster>(0.5F));
  const auto answer = done();
  EXPECT_EQ(answer.to, Rank{7});
  RayBatch batch = batch_with(0);
  ASSERT_TRUE(take_answer(answer.answer, batch));
  EXPECT_EQ(batch.samples[0].red, 3.5F);
  push({kEpoch.value - 1}, 5);  // of a view that is over
  push(kEpoch, 6);
  ASSERT_TRUE(take_answer(done().answer, batch));
  EXPECT_EQ(batch.samples[0].red, 6.5F);
}

TEST_F(RayPoolTest, RaysThatAreNoneAreTold) {
  pool.begin_view(kEpoch, std::make_shared<AddingCaster>(0.5F));
  AdvanceRays bad = request_of(batch_with(1), kEpoch, 1);
  bad.count = 2;
  pool.push({7}, std::move(bad));
  told.acquire();
  EXPECT_THROW(pool.take_done(), FatalError);
}

}  // namespace
}  // namespace goldthread
