// SPDX-License-Identifier: Apache-2.0
#include "master/cine_loop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace goldthread {
namespace {

Camera example() { return {{10, -500, 60}, {3, 0, 20}, {0.1, 0, 1}, 40}; }

/// The angle between two cameras' positions about the axis through the target, in degrees.
double angle_between(const Camera& a, const Camera& b) {
  const glm::dvec3 axis = glm::normalize(a.up);
  const auto across = [&](const Camera& camera) {
    const glm::dvec3 arm = camera.position - camera.target;
    return glm::normalize(arm - axis * glm::dot(arm, axis));
  };
  const glm::dvec3 from = across(a), to = across(b);
  return glm::degrees(std::atan2(glm::dot(axis, glm::cross(from, to)), glm::dot(from, to)));
}

TEST(RockingCameras, AreEquallyFarApartFromOneSideToTheOther) {
  const auto cameras = rocking_cameras(example());
  ASSERT_EQ(cameras.size(), 7u);
  for (int i = 0; i < 7; ++i) {
    const Camera& camera = cameras[static_cast<std::size_t>(i)];
    EXPECT_NEAR(angle_between(example(), camera), -12 + 4 * i, 1e-9);
    EXPECT_NEAR(glm::distance(camera.position, camera.target),
                glm::distance(example().position, example().target), 1e-9);
    EXPECT_EQ(camera.target, example().target);
    EXPECT_EQ(camera.up, example().up);
    EXPECT_EQ(camera.fovy_deg, example().fovy_deg);
  }
}

TEST(RockingCameras, TheMiddleOneIsTheCameraAtRestToTheBit) {
  for (const int frames : {1, 3, 5, 7, 31}) {
    const auto cameras = rocking_cameras(example(), frames, 9.7);
    ASSERT_EQ(cameras.size(), static_cast<std::size_t>(frames));
    EXPECT_EQ(cameras[static_cast<std::size_t>(frames / 2)], example());
  }
}

TEST(RenderingOrder, GoesFromTheMiddleOutwardsToBothSides) {
  EXPECT_THAT(rendering_order(7), testing::ElementsAre(3, 2, 4, 1, 5, 0, 6));
  EXPECT_THAT(rendering_order(1), testing::ElementsAre(0));
}

TEST(CineLoop, IsIdleUntilItBegins) {
  const CineLoop loop;
  EXPECT_TRUE(loop.idle());
  EXPECT_FALSE(loop.complete());
  EXPECT_FALSE(loop.frame());
}

TEST(CineLoop, RendersEachFrameOnceAndIsThenComplete) {
  const auto cameras = rocking_cameras(example(), 5, 10);
  CineLoop loop;
  loop.begin(example(), 5, 10);
  EXPECT_EQ(loop.frames(), 5);
  std::set<int> rendered;
  for (int i = 0; i < 5; ++i) {
    EXPECT_FALSE(loop.complete());
    ASSERT_TRUE(loop.frame());
    EXPECT_TRUE(rendered.insert(*loop.frame()).second);
    EXPECT_EQ(loop.camera(), cameras[static_cast<std::size_t>(*loop.frame())]);
    loop.frame_done();
  }
  EXPECT_TRUE(loop.complete());
  EXPECT_FALSE(loop.frame());
  loop.frame_done();
  EXPECT_TRUE(loop.complete()) << "a late answer changes nothing";
}

TEST(CineLoop, InputResetsItWhateverItDoes) {
  for (const int done : {0, 3, 7}) {
    CineLoop loop;
    loop.begin(example());
    for (int i = 0; i < done; ++i) loop.frame_done();
    loop.reset();
    EXPECT_TRUE(loop.idle());
    EXPECT_FALSE(loop.complete());
    EXPECT_FALSE(loop.frame());
    loop.frame_done();
    EXPECT_TRUE(loop.idle());
    loop.begin(example());
    EXPECT_EQ(loop.frame(), 3) << "and begins anew from the middle";
  }
}

}  // namespace
}  // namespace goldthread
