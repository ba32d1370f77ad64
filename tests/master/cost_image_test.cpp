// SPDX-License-Identifier: Apache-2.0
#include "master/cost_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "common/scene/camera.h"

namespace goldthread {
namespace {

constexpr ImageSize kImage{320, 320};
constexpr int kBlocks = 20;

/// Looks along y at the origin from a distance at which the picture is 320 mm high there: a pixel
/// of the plane through the origin is a millimetre.
Camera camera_at(double distance, double fovy_distance = 400) {
  Camera camera;
  camera.position = {0, -distance, 0};
  camera.target = {0, 0, 0};
  camera.up = {0, 0, 1};
  camera.fovy_deg = 2 * std::atan(160 / fovy_distance) * 180 / M_PI;
  return camera;
}
const std::vector<glm::dvec3> kAtOrigin{{0, 0, 0}};

PixelRect block(int column, int row) { return {16 * column, 16 * row, 16, 16}; }

/// The cost of a block as a function of its centre, from the picture's centre, in pixels.
using Field = std::function<double(double x, double y)>;
CostImage image_of(const Field& field) {
  CostImage image(kImage);
  for (int row = 0; row < kBlocks; ++row)
    for (int column = 0; column < kBlocks; ++column)
      image.record(block(column, row), field(16 * column + 8 - 160, 16 * row + 8 - 160));
  return image;
}

/// Compares the blocks whose centres are less than `reach` pixels from the picture's centre.
void expect_field(const CostImage& image, const Field& field, double reach, double tolerance) {
  int compared = 0;
  for (int row = 0; row < kBlocks; ++row) {
    for (int column = 0; column < kBlocks; ++column) {
      const double x = 16 * column + 8 - 160, y = 16 * row + 8 - 160;
      if (std::max(std::abs(x), std::abs(y)) >= reach) continue;
      EXPECT_NEAR(image.predict_us(block(column, row)), field(x, y), tolerance) << x << " " << y;
      ++compared;
    }
  }
  EXPECT_GT(compared, 50);
}

TEST(CostImage, SpreadsATilesCostEvenlyAndSumsItAgain) {
  CostImage image({100, 70});
  EXPECT_TRUE(image.empty());
  EXPECT_EQ(image.predict_us({0, 0, 64, 64}), 0);
  image.record({64, 0, 36, 64}, 36 * 64);
  EXPECT_FALSE(image.empty());
  EXPECT_DOUBLE_EQ(image.predict_us({64, 0, 36, 64}), 36 * 64);
  EXPECT_DOUBLE_EQ(image.predict_us({80, 16, 16, 16}), 256);
  EXPECT_DOUBLE_EQ(image.predict_us({96, 0, 4, 16}), 64) << "a clipped block has fewer pixels";
  EXPECT_DOUBLE_EQ(image.predict_us({0, 0, 64, 64}), 4096) << "as what is known";
  image.record({64, 0, 36, 64}, 0);
  EXPECT_FALSE(image.empty()) << "nothing is a cost, too";
  EXPECT_DOUBLE_EQ(image.predict_us({0, 0, 64, 64}), 0);
}

TEST(CostImage, FollowsACameraThatComesNearer) {
  // From 400 to 320 mm: what was at x is at 1.25 x.
  const Field before = [](double x, double y) { return 1000 + 2 * x - 3 * y; };
  CostImage image = image_of(before);
  image.warp(warp_of(kImage, camera_at(400), camera_at(320), kAtOrigin));
  // Between blocks a linear field is interpolated without error.
  expect_field(
      image, [&](double x, double y) { return before(x / 1.25, y / 1.25); }, 160, 1e-6);
}

TEST(CostImage, FollowsACameraThatGoesAway) {
  const Field before = [](double x, double y) { return 1000 + 2 * x - 3 * y; };
  CostImage image = image_of(before);
  image.warp(warp_of(kImage, camera_at(400), camera_at(500), kAtOrigin));
  // What is farther out than the old picture's outermost centres, 152 pixels, is as these were.
  expect_field(
      image,
      [&](double x, double y) {
        const auto old = [](double at) { return std::clamp(1.25 * at, -152.0, 152.0); };
        return before(old(x), old(y));
      },
      160, 1e-6);
}

TEST(CostImage, FollowsACameraThatMovesAside) {
  // 32 mm to the right: all goes two blocks to the left.
  const Field before = [](double x, double y) { return 500 + std::abs(x + 3 * y); };
  CostImage image = image_of(before);
  Camera moved = camera_at(400);
  moved.position.x += 32;
  moved.target.x += 32;
  image.warp(warp_of(kImage, camera_at(400), moved, kAtOrigin));
  expect_field(
      image, [&](double x, double y) { return before(x + 32, y); }, 120, 1e-6);
}

TEST(CostImage, TakesTheDepthOfTheMedianPoint) {
  // Seen at half the distance, a step to the side moves the picture twice as far.
  const Field before = [](double x, double) { return 1000 + 4 * x; };
  Camera moved = camera_at(400);
  moved.position.x += 16;
  moved.target.x += 16;
  CostImage image = image_of(before);
  const std::vector<glm::dvec3> points{
      {0, -200, 0}, {5, -200, 0}, {0, 900, 0}, {0, -399, 0}, {0, -1000, 0}};  // one is behind
  image.warp(warp_of(kImage, camera_at(400), moved, points));
  expect_field(
      image, [&](double x, double y) { return before(x + 32, y); }, 120, 1e-6);
}

TEST(CostImage, StaysAsItIsWithoutPointsOrMovement) {
  const Field field = [](double x, double y) { return std::abs(x) + 2 * std::abs(y); };
  const std::vector<std::vector<glm::dvec3>> none_ahead{{}, {{0, -1000, 0}}};
  for (const auto& points : none_ahead) {
    CostImage image = image_of(field);
    image.warp(warp_of(kImage, camera_at(400), camera_at(100), points));
    expect_field(image, field, 160, 0);
  }
  CostImage image = image_of(field);
  image.warp(warp_of(kImage, camera_at(400), camera_at(400), kAtOrigin));
  expect_field(image, field, 160, 1e-6);
}

TEST(CostImage, DoesNotTakeWhatIsUnknownForCheap) {
  CostImage image(kImage);
  for (int row = 0; row < kBlocks; ++row)
    for (int column = 0; column < kBlocks / 2; ++column) image.record(block(column, row), 640);
  Camera moved = camera_at(400);
  moved.position.x += 8;
  moved.target.x += 8;
  image.warp(warp_of(kImage, camera_at(400), moved, kAtOrigin));
  expect_field(
      image, [](double, double) { return 640; }, 160, 1e-6);
}

TEST(CostImage, KnowsNothingOfWhatWasBehindTheCamera) {
  CostImage image = image_of([](double, double) { return 640; });
  Camera turned = camera_at(400);
  turned.target = {0, -800, 0};
  const std::vector<glm::dvec3> ahead{{0, -800, 0}};
  image.warp(warp_of(kImage, camera_at(400), turned, ahead));
  EXPECT_TRUE(image.empty());
}

}  // namespace
}  // namespace goldthread
