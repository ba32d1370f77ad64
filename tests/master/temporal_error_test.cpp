// SPDX-License-Identifier: Apache-2.0
#include "master/temporal_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace goldthread {
namespace {

constexpr ImageSize kSize{400, 300};

Camera example() { return {{0, -500, 0}, {0, 0, 0}, {0, 0, 1}, 30}; }

std::vector<glm::dvec3> cube_corners(double half_edge) {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 8; ++i) {
    points.emplace_back(i & 1 ? half_edge : -half_edge, i & 2 ? half_edge : -half_edge,
                        i & 4 ? half_edge : -half_edge);
  }
  return points;
}

Camera moved(Camera camera, const glm::dvec3& by) {
  camera.position += by;
  camera.target += by;
  return camera;
}

TEST(TemporalError, IsZeroForTheSameCameraAndWithoutPoints) {
  EXPECT_EQ(temporal_error_px(cube_corners(50), example(), example(), kSize), 0);
  EXPECT_EQ(temporal_error_px({}, example(), orbit(example(), 20), kSize), 0);
}

TEST(TemporalError, ASidewaysStepMovesAPlaneByItsPixels) {
  const std::vector<glm::dvec3> plane{{-80, 0, 10}, {0, 0, 0}, {60, 0, -40}};
  const double pixel_mm = 2 * 500 * std::tan(glm::radians(15.0)) / kSize.height;
  const Camera aside = moved(example(), {3 * pixel_mm, 0, 4 * pixel_mm});
  EXPECT_NEAR(temporal_error_px(plane, example(), aside, kSize), 5, 1e-9);
}

TEST(TemporalError, IsTheRootOfTheMeanSquare) {
  // Turned about an axis through the first point: that one rests, the other moves.
  const std::vector<glm::dvec3> both{{0, 0, 0}, {100, 0, 0}};
  const Camera turned = orbit(example(), 5);
  const double one = temporal_error_px(std::vector{both[1]}, example(), turned, kSize);
  EXPECT_GT(one, 0.1);
  EXPECT_NEAR(temporal_error_px(both, example(), turned, kSize), one / std::sqrt(2.0), 1e-9);
}

TEST(TemporalError, DoesNotDependOnWhichCameraIsTheNewer) {
  const Camera turned = orbit(moved(example(), {5, 20, -3}), 8);
  EXPECT_DOUBLE_EQ(temporal_error_px(cube_corners(50), example(), turned, kSize),
                   temporal_error_px(cube_corners(50), turned, example(), kSize));
}

TEST(TemporalError, GrowsInProportionToSmallTurns) {
  const auto points = cube_corners(50);
  const double one = temporal_error_px(points, example(), orbit(example(), 0.01), kSize);
  const double two = temporal_error_px(points, example(), orbit(example(), 0.02), kSize);
  EXPECT_GT(one, 0);
  EXPECT_NEAR(two / one, 2, 1e-3);
}

TEST(TemporalError, APointThatOnlyOneCameraHasInFrontMovesByTheHeight) {
  const std::vector<glm::dvec3> points{{0, 0, 0}};
  Camera away = example();
  away.target = {0, -1000, 0};
  EXPECT_EQ(temporal_error_px(points, example(), away, kSize), kSize.height);
  EXPECT_EQ(temporal_error_px(points, away, moved(away, {0, 0, 9}), kSize), 0)
      << "neither has it in front";
}

TEST(TemporalError, NoPointMovesByMoreThanTheHeight) {
  const std::vector<glm::dvec3> beside{{1e300, -499.999999, 0}, {5, -499.9, 3}};
  const double error = temporal_error_px(beside, example(), moved(example(), {2, 0, 1}), kSize);
  EXPECT_GT(error, 0);
  EXPECT_LE(error, kSize.height);
}

TEST(SpatialError, IsTheMovementThatChangesThePictureAsMuch) {
  EXPECT_DOUBLE_EQ(spatial_error_px(9, 4), 1.5);
  EXPECT_DOUBLE_EQ(spatial_error_px(9e-8, 4e-8), 1.5);
}

TEST(SpatialError, OfNoErrorIsZeroAndOfNoGradientIsBounded) {
  EXPECT_EQ(spatial_error_px(0, 0), 0);
  EXPECT_EQ(spatial_error_px(0, 3), 0);
  EXPECT_EQ(spatial_error_px(1e-9, 0), kLargestSpatialErrorPx);
  EXPECT_EQ(spatial_error_px(1, 1e-300), kLargestSpatialErrorPx);
}

}  // namespace
}  // namespace goldthread
