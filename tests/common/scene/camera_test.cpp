// SPDX-License-Identifier: Apache-2.0
#include "common/scene/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace goldthread {
namespace {

Camera example() { return {{10, -500, 60}, {3, 0, 20}, {0.1, 0, 1}, 40}; }

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Camera, ItsBasisIsOrthonormalAndRightHanded) {
  const CameraBasis basis = camera_basis(example());
  EXPECT_NEAR(glm::length(basis.right), 1, 1e-14);
  EXPECT_NEAR(glm::length(basis.up), 1, 1e-14);
  EXPECT_NEAR(glm::dot(basis.right, basis.forward), 0, 1e-14);
  EXPECT_NEAR(glm::dot(basis.up, basis.forward), 0, 1e-14);
  expect_near(glm::cross(basis.right, basis.up), -basis.forward, 1e-14);
  EXPECT_GT(glm::dot(basis.up, example().up), 0);
}

TEST(Camera, TheRayThroughTheMiddleMeetsTheTarget) {
  const Ray ray = camera_ray(example(), {640, 480}, 320, 240);
  expect_near(ray.direction, glm::normalize(example().target - example().position), 1e-14);
  EXPECT_EQ(ray.origin, example().position);
}

TEST(Camera, TopAndBottomEdgesAreFovyApart) {
  const Camera camera = example();
  for (const ImageSize size : {ImageSize{640, 480}, ImageSize{100, 900}}) {
    const Ray top = camera_ray(camera, size, size.width / 2.0, 0);
    const Ray bottom = camera_ray(camera, size, size.width / 2.0, size.height);
    EXPECT_NEAR(glm::degrees(std::acos(glm::dot(top.direction, bottom.direction))), 40, 1e-10);
    EXPECT_GT(glm::dot(top.direction, camera_basis(camera).up), 0);
  }
}

TEST(Projection, FindsThePixelWhoseRayPassesThroughAPoint) {
  const Camera camera = example();
  for (const ImageSize size : {ImageSize{640, 480}, ImageSize{100, 900}}) {
    const Projection projection(camera, size);
    for (const auto& [x, y] : {std::pair{0.5, 0.5}, {320.25, 17.0}, {-90.0, 1000.0}}) {
      const Ray ray = camera_ray(camera, size, x, y);
      for (const double distance : {1e-3, 1.0, 700.0}) {
        const auto seen = projection.at(ray.origin + distance * ray.direction);
        ASSERT_TRUE(seen);
        EXPECT_NEAR(seen->x, x, 1e-6);
        EXPECT_NEAR(seen->y, y, 1e-6);
      }
    }
  }
}

TEST(Projection, PointsBehindOrBesideTheCameraAreNotSeen) {
  const Camera camera = example();
  const CameraBasis basis = camera_basis(camera);
  const Projection projection(camera, {640, 480});
  EXPECT_FALSE(projection.at(camera.position));
  EXPECT_FALSE(projection.at(camera.position - basis.forward));
  EXPECT_FALSE(projection.at(camera.position - 0.01 * basis.forward + 10.0 * basis.right));
  EXPECT_FALSE(projection.at(glm::dvec3(std::numeric_limits<double>::quiet_NaN())));
}

TEST(Camera, PixelsAreSquareAndXGrowsToTheRight) {
  const Camera camera = example();
  const CameraBasis basis = camera_basis(camera);
  const ImageSize size{640, 480};
  const auto on_plane = [&](double x, double y) {
    const glm::dvec3 d = camera_ray(camera, size, x, y).direction;
    return d / glm::dot(d, basis.forward);
  };
  const glm::dvec3 step_x = on_plane(101, 50) - on_plane(100, 50);
  const glm::dvec3 step_y = on_plane(100, 51) - on_plane(100, 50);
  EXPECT_NEAR(glm::length(step_x), glm::length(step_y), 1e-14);
  EXPECT_GT(glm::dot(step_x, basis.right), 0);
  EXPECT_LT(glm::dot(step_y, basis.up), 0);
}

TEST(Orbit, WholeTurnsGiveTheSameCameraToTheBit) {
  for (const double degrees : {0.0, 360.0, -360.0, 720.0}) {
    EXPECT_EQ(orbit(example(), degrees), example());
  }
}

TEST(Orbit, KeepsTheDistanceAndTheHeightAlongUp) {
  const Camera camera = example();
  const Camera turned = orbit(camera, 77);
  const glm::dvec3 arm = camera.position - camera.target, after = turned.position - turned.target;
  EXPECT_NEAR(glm::length(arm), glm::length(after), 1e-10);
  EXPECT_NEAR(glm::dot(arm, camera.up), glm::dot(after, camera.up), 1e-10);
  EXPECT_EQ(turned.target, camera.target);
  EXPECT_EQ(turned.up, camera.up);
}

TEST(Orbit, TurnsCounterClockwiseSeenFromAbove) {
  const Camera camera{{10, 0, 0}, {0, 0, 0}, {0, 0, 2}, 30};
  expect_near(orbit(camera, 90).position, {0, 10, 0}, 1e-14);
}

TEST(Orbit, TwoTurnsAddUp) {
  expect_near(orbit(orbit(example(), 30), 45).position, orbit(example(), 75).position, 1e-10);
}

TEST(CameraFault, NamesWhatMakesACameraUseless) {
  const auto fault_of = [](auto change) {
    Camera camera = example();
    change(camera);
    return camera_fault(camera).field;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(camera_fault(example()).any());
  EXPECT_EQ(fault_of([&](Camera& c) { c.position.x = nan; }), "position");
  EXPECT_EQ(fault_of([&](Camera& c) { c.target.y = INFINITY; }), "target");
  EXPECT_EQ(fault_of([&](Camera& c) { c.target = c.position; }), "target");
  EXPECT_EQ(fault_of([&](Camera& c) { c.up = {0, 0, 0}; }), "up");
  EXPECT_EQ(fault_of([&](Camera& c) { c.up = 3.0 * (c.position - c.target); }), "up");
  EXPECT_EQ(fault_of([&](Camera& c) { c.fovy_deg = 180; }), "fovy");
  EXPECT_EQ(fault_of([&](Camera& c) { c.fovy_deg = nan; }), "fovy");
}

TEST(CameraFault, NeitherHugeNorTinyNumbersHideAGoodCamera) {
  EXPECT_FALSE(camera_fault({{0, 0, 1e-200}, {0, 0, 0}, {0, 1e-200, 0}, 30}).any());
  const Camera huge{{0, 0, 1e200}, {0, 0, 0}, {0, 1e200, 0}, 30};
  EXPECT_FALSE(camera_fault(huge).any());
  expect_near(camera_basis(huge).right, {1, 0, 0}, 1e-14);
}

}  // namespace
}  // namespace goldthread
