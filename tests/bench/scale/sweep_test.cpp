// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/sweep.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace goldthread::bench {
namespace {

/// Each block costs 100 µs, a tile of 64×64 pixels 1600.
RecordedView even_view() {
  const CostRecord image{4, 4, {std::vector<StepCost>(16, {100, 1000, 1})}};
  return {"even", "one step", image, image};
}

ClusterModel model_of(double quantum_us) {
  ClusterModel model;
  model.master.push_back({1, quantum_us / 2, quantum_us / 2, 0, 0});
  return model;
}

SweepSettings settings_of(std::vector<int> megapixels, std::vector<int> workers) {
  SweepSettings settings;
  settings.megapixels = std::move(megapixels);
  settings.workers = std::move(workers);
  return settings;
}

TEST(Sweep, OneMasterFeedsAsManyWorkersAsItsTimeAllows) {
  // 1600 µs a tile and 10 µs for it: 160 workers.
  const auto points =
      sweep_one_level({even_view()}, model_of(10), settings_of({16}, {16, 64, 1024}));
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points[0].tiles, 4096U);
  EXPECT_DOUBLE_EQ(points[0].tile_us, 1600);
  EXPECT_GT(points[0].frame.efficiency, 0.95);
  EXPECT_GT(points[1].frame.efficiency, 0.9);
  EXPECT_NEAR(points[2].frame.efficiency, 160.0 / 1024, 0.02);
  EXPECT_EQ(limit_of(points[2]), "master");
}

TEST(Sweep, FewTilesAreNotEnough) {
  const auto points = sweep_one_level({even_view()}, model_of(0.01), settings_of({1}, {1024}));
  EXPECT_EQ(points[0].tiles, 256U);
  EXPECT_LE(points[0].frame.efficiency, 0.25);
  EXPECT_EQ(limit_of(points[0]), "too few tiles");
}

TEST(Sweep, ASecondLevelMendsASlowMaster) {
  const std::vector<RecordedView> views{even_view()};
  const SweepSettings settings = settings_of({16}, {64, 4096});
  const ClusterModel model = model_of(4);
  const auto points = sweep_two_levels(views, model, settings);
  const SweepPoint* plan = second_level(points, 0, 16, 0.8);
  ASSERT_NE(plan, nullptr);
  EXPECT_GE(plan->frame.efficiency, 0.8);
  EXPECT_GT(plan->shape.masters, 1);
  for (const SweepPoint& point : points) {
    if (point.shape.masters >= plan->shape.masters) continue;
    EXPECT_LT(point.frame.efficiency, point.shape.masters == 1 ? 0.5 : 0.8);
  }
  const auto like = sweep_like(*plan, views, model, settings);
  ASSERT_EQ(like.size(), 2U);
  EXPECT_DOUBLE_EQ(like[1].frame.us, plan->frame.us);
  EXPECT_EQ(like[0].shape.masters, std::max(1, 64 * plan->shape.masters / 4096));
}

TEST(Sweep, WhereNoSecondLevelReachesTheGoalTheBestIsNamed) {
  const auto points = sweep_two_levels({even_view()}, model_of(4), settings_of({16}, {4096}));
  const SweepPoint* plan = second_level(points, 0, 16, 1.1);
  ASSERT_NE(plan, nullptr);
  for (const SweepPoint& point : points) {
    if (point.shape.masters == 1) continue;
    EXPECT_LE(point.frame.efficiency, plan->frame.efficiency);
  }
  EXPECT_EQ(second_level(points, 1, 16, 0.8), nullptr);
}

}  // namespace
}  // namespace goldthread::bench
