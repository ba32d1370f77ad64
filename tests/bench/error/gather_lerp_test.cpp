// SPDX-License-Identifier: Apache-2.0
#include "bench/error/gather_lerp.h"

#include <gtest/gtest.h>

#include "common/scene/camera.h"

namespace goldthread::bench {
namespace {

TEST(GatherAndLerp, TakesAtLeastAsManySamplesAsAskedFor) {
  PacketRays rays{};
  for (int i = 0; i < PacketRays::kRays; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      rays.first[axis][i] = 100;
      rays.step[axis][i] = -0.25F;
    }
  }
  EXPECT_GE(gather_and_lerp(rays, 100000), 100000u);
}

TEST(GatherAndLerp, PositionsStayPositiveAndAreTheCamerasOwn) {
  VolumeGeometry geometry;
  geometry.size = {64, 64, 64};
  Camera camera;
  camera.position = {200, -300, 50};
  camera.target = {32, 32, 32};
  camera.up = {0, 0, 1};
  const double step = 0.5;
  const PacketRays rays = packet_in_the_middle(camera, {512, 512}, geometry, step);
  for (int i = 0; i < PacketRays::kRays; ++i) {
    double length = 0;
    for (int axis = 0; axis < 3; ++axis) {
      // 256 samples are taken along a ray before it starts anew.
      EXPECT_GT(rays.first[axis][i] + 256 * rays.step[axis][i], 0);
      length += double(rays.step[axis][i]) * double(rays.step[axis][i]);
    }
    EXPECT_NEAR(std::sqrt(length), step, 1e-6);
  }
  EXPECT_NE(rays.first[0][0], rays.first[0][3]);
}

}  // namespace
}  // namespace goldthread::bench
