// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/role_costs.h"

#include <gtest/gtest.h>

#include "bench/scale/prompt_workers.h"
#include "master/cluster.h"

namespace goldthread::bench {
namespace {

TEST(PromptWorkers, ARealMasterHasAllItsTilesDone) {
  const Topology topology{1, 5};
  PromptWorkers workers(topology, {});
  Cluster cluster(workers, topology, {2, false});
  cluster.greet();
  cluster.load_volume({}, [](double) {});
  Scene scene;
  scene.camera = Camera{};
  cluster.commit(scene);
  workers.answer();
  cluster.begin_view(scene, {TileGrid::squares({640, 640}, 64), {}});
  EXPECT_EQ(workers.answer().quanta, 15U);  // two threads and a spare tile each
  std::size_t quanta = 15;
  while (cluster.view().cast() == kNoStep) {
    cluster.poll(std::chrono::microseconds(0));
    quanta += workers.answer().quanta;
  }
  EXPECT_EQ(quanta, 100U);
}

TEST(RoleCosts, PlacingTakesLongerForMoreBytes) {
  const PlacingCosts costs = measure_placing();
  EXPECT_GT(costs.place.us_per_byte, 0);
  EXPECT_LT(costs.place.us_per_byte, 1);
}

}  // namespace
}  // namespace goldthread::bench
