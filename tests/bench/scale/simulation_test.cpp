// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/simulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "common/protocol/wire.h"

namespace goldthread::bench {
namespace {

/// One row of tiles that cost so much in each of `steps` steps, and send `bytes` each.
FrameWork work(const std::vector<double>& costs, int steps = 1, double bytes = 0) {
  FrameWork result{TileGrid::squares({64 * int(costs.size()), 64}, 64), {}};
  std::vector<StepCost> tiles;
  for (const double us : costs) tiles.push_back({us, bytes, 1});
  result.steps.assign(std::size_t(steps), tiles);
  return result;
}

/// Messages cost nothing and take no time.
ClusterModel free_messages() {
  ClusterModel model;
  model.master.push_back({});
  return model;
}

ClusterShape shape_of(int workers, int spare = 1) {
  ClusterShape shape;
  shape.workers = workers;
  shape.spare = spare;
  shape.strategy = {};
  return shape;
}

SimulatedFrame frame_of(const FrameWork& costs, const ClusterModel& model,
                        const ClusterShape& shape) {
  return simulate(costs, costs, model, shape);
}

/// The shortest time in which `machines` can do the jobs: tries all.
double optimum(const std::vector<double>& jobs, std::vector<double>& loads, std::size_t job = 0) {
  if (job == jobs.size()) return *std::max_element(loads.begin(), loads.end());
  double best = std::numeric_limits<double>::infinity();
  for (double& load : loads) {
    load += jobs[job];
    best = std::min(best, optimum(jobs, loads, job + 1));
    load -= jobs[job];
  }
  return best;
}

/// Longest first, each to the machine that is free first.
double list_schedule(std::vector<double> jobs, std::size_t machines) {
  std::sort(jobs.begin(), jobs.end(), std::greater<>());
  std::vector<double> loads(machines);
  for (const double job : jobs) *std::min_element(loads.begin(), loads.end()) += job;
  return *std::max_element(loads.begin(), loads.end());
}

TEST(Simulation, OneWorkerTakesTheSumOfTilesAndMessages) {
  ClusterModel model = free_messages();
  model.link = {{2, 0.001}, {3, 0.002}, {50, 0.01}};
  model.master[0] = {1, 5, 7, 0.5, 11};
  model.place = {13, 0.003};
  const FrameWork costs = work({4000, 3000, 2000}, 1, 1000);
  const double view = double(encode(ToWorker(BeginView{})).size());
  const double order = double(encode(ToWorker(RenderTiles{{{}, {}}})).size());
  const double samples = 1000 + double(encode(ToCompositor(Samples{})).size());
  const double done = double(encode(ToMaster(TilesDone{{{}}})).size());
  const double ready = double(encode(ToMaster(BandReady{})).size());
  const LinkCosts& link = model.link;
  // The master queues three tiles, tells the worker the view, and sends the first tile and the
  // spare in one message.
  const double first = 3 * 0.5 + (11 + link.send.at(view)) + 2 * 7 + link.send.at(order) +
                       link.transit.at(order) + link.receive.at(order);
  // The worker always has the next tile when it has sent the one before.
  const double computed = 9000 + 2 * (link.send.at(samples) + link.send.at(done));
  // The last tile's samples reach the compositor, whose word reaches the master.
  const double last = link.send.at(samples) + link.transit.at(samples) + link.receive.at(samples) +
                      model.place.at(1000) + link.send.at(ready) + link.transit.at(ready) +
                      link.receive.at(ready) + 5;
  const SimulatedFrame frame = frame_of(costs, model, shape_of(1));
  EXPECT_NEAR(frame.us, first + computed + last, 1e-6);
  EXPECT_NEAR(frame.efficiency, 9000 / frame.us, 1e-9);
  EXPECT_EQ(frame.quanta, 3U);
}

TEST(Simulation, EqualTilesTakeAsManyRoundsAsTheyMust) {
  for (const int tiles : {1, 7, 16, 17, 100})
    for (const int workers : {1, 2, 5, 16}) {
      const FrameWork costs = work(std::vector<double>(std::size_t(tiles), 1000));
      const double rounds = std::ceil(double(tiles) / workers);
      EXPECT_DOUBLE_EQ(frame_of(costs, free_messages(), shape_of(workers, 0)).us, 1000 * rounds)
          << tiles << " tiles, " << workers << " workers";
    }
}

TEST(Simulation, ThreadsOfAWorkerComputeAtOnce) {
  const FrameWork costs = work(std::vector<double>(24, 1000));
  ClusterShape shape = shape_of(2);
  shape.threads = 4;
  EXPECT_DOUBLE_EQ(frame_of(costs, free_messages(), shape).us, 3000);
}

TEST(Simulation, StepsFollowEachOther) {
  const FrameWork costs = work(std::vector<double>(8, 1000), 5);
  const SimulatedFrame frame = frame_of(costs, free_messages(), shape_of(4, 0));
  EXPECT_DOUBLE_EQ(frame.us, 10000);
  EXPECT_DOUBLE_EQ(frame.efficiency, 1);
  EXPECT_EQ(frame.taken_over, 0U);
}

TEST(Simulation, AMasterThatIsTheLimitTakesItsTimeForEachQuantum) {
  ClusterModel model = free_messages();
  model.master[0].done_us = 30;
  model.master[0].supply_us = 20;
  constexpr int kTiles = 1000;
  const FrameWork costs = work(std::vector<double>(kTiles, 1));
  const SimulatedFrame frame = frame_of(costs, model, shape_of(64));
  // All quanta go out and come back through it; the last word is the compositor's.
  EXPECT_NEAR(frame.us, 50.0 * kTiles, 200);
  EXPECT_GT(frame.master_busy, 0.99);
}

TEST(Simulation, ACompositorThatIsTheLimitTakesItsTimeForEachByte) {
  ClusterModel model = free_messages();
  model.place = {10, 0.5};
  constexpr int kTiles = 100;
  const FrameWork costs = work(std::vector<double>(kTiles, 100), 1, 4000);
  const SimulatedFrame frame = frame_of(costs, model, shape_of(50, 0));
  EXPECT_NEAR(frame.us, kTiles * 2010 + 100, 1);
  EXPECT_GT(frame.compositor_busy, 0.99);
  // The last report came when each worker had cast its two tiles.
  EXPECT_NEAR(frame.compositors_late_us, frame.us - 200, 1e-6);
}

TEST(Simulation, BandsShareTheSamplesOut) {
  ClusterModel model = free_messages();
  model.place = {1000, 0};
  FrameWork costs{TileGrid::squares({64, 64 * 8}, 64), {std::vector<StepCost>(8, {1, 1, 1})}};
  ClusterShape shape = shape_of(8, 0);
  shape.compositors = 4;
  EXPECT_DOUBLE_EQ(frame_of(costs, model, shape).us, 2001);
}

TEST(Simulation, WithoutASpareTileItIsLongestFirst) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> cost(1, 1000);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<double> costs(std::size_t(5 + trial % 4));
    for (double& each : costs) each = std::floor(cost(random));
    for (const int machines : {2, 3}) {
      const double us = frame_of(work(costs), free_messages(), shape_of(machines, 0)).us;
      EXPECT_DOUBLE_EQ(us, list_schedule(costs, std::size_t(machines)));
      std::vector<double> loads(static_cast<std::size_t>(machines));
      // Graham 1969.
      EXPECT_LE(us, (4.0 / 3 - 1.0 / (3 * machines)) * optimum(costs, loads) + 1e-9);
    }
  }
}

TEST(Simulation, GrahamsWorstCaseIsReached) {
  // Two machines: 3 3 2 2 2 takes 7 where 6 would do.
  const FrameWork costs = work({300, 300, 200, 200, 200});
  EXPECT_DOUBLE_EQ(frame_of(costs, free_messages(), shape_of(2, 0)).us, 700);
}

TEST(Simulation, IsTheSameEachTime) {
  std::mt19937 random(3);
  std::vector<double> costs(500);
  for (double& each : costs) each = std::uniform_real_distribution<double>(1, 500)(random);
  ClusterModel model = free_messages();
  model.link = {{2, 0}, {3, 0}, {50, 0}};
  const SimulatedFrame a = frame_of(work(costs, 4), model, shape_of(37));
  const SimulatedFrame b = frame_of(work(costs, 4), model, shape_of(37));
  EXPECT_EQ(a.us, b.us);
  EXPECT_EQ(a.taken_over, b.taken_over);
}

TEST(Simulation, SubMastersShareTheMastersWork) {
  ClusterModel model = free_messages();
  model.master[0].done_us = 25;
  model.master[0].supply_us = 25;
  constexpr int kTiles = 4096;
  const FrameWork costs = work(std::vector<double>(kTiles, 100));
  ClusterShape shape = shape_of(256);
  const double one = frame_of(costs, model, shape).us;
  shape.masters = 16;
  const SimulatedFrame many = frame_of(costs, model, shape);
  EXPECT_NEAR(one, 50.0 * kTiles, 500);
  EXPECT_NEAR(many.us, one / 16, 2000);
  // The view and its end, for each sub-master, and the compositor's word.
  EXPECT_EQ(many.top_messages, 2U * 16 + 1);
}

TEST(Simulation, MoreMastersThanTilesLeaveSomeIdle) {
  const FrameWork costs = work({100, 100}, 3);
  ClusterShape shape = shape_of(8, 0);
  shape.masters = 8;
  EXPECT_DOUBLE_EQ(frame_of(costs, free_messages(), shape).us, 300);
}

TEST(Simulation, ATileThatChangesHandsIsCastFromTheBeginning) {
  // One worker holds all tiles of the second step, whose costs nobody foresaw.
  FrameWork before = work({100, 100, 100, 100, 100, 100}, 2);
  FrameWork now = before;
  now.steps[0] = {{1000, 0, 1}, {10, 0, 1}, {10, 0, 1}, {10, 0, 1}, {10, 0, 1}, {10, 0, 1}};
  for (StepCost& tile : now.steps[1]) tile.us = 500;
  const SimulatedFrame frame = simulate(now, before, free_messages(), shape_of(2, 0));
  EXPECT_GT(frame.taken_over, 0U);
  // Three steps of 500 each, and what taking over costs: at most what the scheduler saw in it.
  EXPECT_GE(frame.us, 1000 + 3 * 500);
  EXPECT_LE(frame.us, 1000 + 5 * 500);
}

}  // namespace
}  // namespace goldthread::bench
