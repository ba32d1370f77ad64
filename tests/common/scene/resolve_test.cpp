// SPDX-License-Identifier: Apache-2.0
#include "common/scene/resolve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/scene/camera.h"
#include "common/scene/scene_file.h"

namespace goldthread {
namespace {

/// A head-like volume: 70 % background noise near 0, tissue around 90 of 255.
VolumeInfo head() {
  VolumeInfo info;
  info.type = VoxelType::kUInt8;
  info.geometry.size = {181, 217, 181};
  info.geometry.spacing_mm = {1, 1, 1};
  info.geometry.origin_mm = {-90, -126, -72};
  info.minimum = 0;
  info.maximum = 255;
  info.histogram.resize(256);
  for (int i = 0; i < 256; ++i) {
    const double noise = 7e5 * std::exp(-i / 4.0),
                 tissue = 2e4 * std::exp(-std::pow((i - 90) / 30.0, 2));
    info.histogram[static_cast<std::size_t>(i)] = static_cast<std::uint64_t>(noise + tissue) + 1;
  }
  return info;
}

Scene bare() { return value_or_throw(read_scene("head.nii.gz")); }

void expect_usable(const TransferFunction& function) {
  ASSERT_FALSE(function.color.empty());
  ASSERT_FALSE(function.opacity.empty());
  EXPECT_GT(function.unit_distance_mm, 0);
  EXPECT_TRUE(std::isfinite(function.unit_distance_mm));
  EXPECT_TRUE(std::is_sorted(function.color.begin(), function.color.end(),
                             [](const auto& a, const auto& b) { return a.value < b.value; }));
  EXPECT_TRUE(std::is_sorted(function.opacity.begin(), function.opacity.end(),
                             [](const auto& a, const auto& b) { return a.value < b.value; }));
  EXPECT_FALSE(function.color_spans_range || function.opacity_spans_range);
}

TEST(Resolve, FillsInEverythingARendererNeeds) {
  const Scene scene = resolve_scene(bare(), head());
  ASSERT_TRUE(scene.camera);
  EXPECT_FALSE(camera_fault(*scene.camera).any());
  expect_usable(*scene.volumes[0].transfer_function);
}

TEST(Resolve, IsIdempotent) {
  const Scene once = resolve_scene(bare(), head());
  EXPECT_EQ(resolve_scene(once, head()), once);
}

TEST(Resolve, KeepsWhatTheSceneSays) {
  Scene scene = bare();
  scene.camera = Camera{{1, 2, 3}, {4, 5, 6}, {0, 1, 0}, 10};
  scene.volumes[0].transfer_function = TransferFunction{2, {{0, {1, 0, 0}}}, {{0, 0.5}}};
  scene.volumes[0].shading.reset();
  scene.volumes[0].isosurfaces = {{7}};
  EXPECT_EQ(resolve_scene(scene, head()), scene);
}

TEST(Resolve, TheWholeVolumeIsInThePictureAndFillsIt) {
  for (const ImageSize size : {ImageSize{512, 512}, ImageSize{800, 300}, ImageSize{300, 800}}) {
    Scene scene = bare();
    scene.image.size = size;
    const Camera camera = *resolve_scene(scene, head()).camera;
    const CameraBasis basis = camera_basis(camera);
    const double half = std::tan(glm::radians(camera.fovy_deg) / 2);
    double furthest = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 at =
          glm::dvec3(-90, -126, -72) +
          glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2 & 1) * glm::dvec3(180, 216, 180);
      const glm::dvec3 d = at - camera.position;
      const double depth = glm::dot(d, basis.forward);
      const double x = std::abs(glm::dot(d, basis.right)) / depth / half * size.height / size.width;
      const double y = std::abs(glm::dot(d, basis.up)) / depth / half;
      furthest = std::max({furthest, x, y});
    }
    EXPECT_LE(furthest, 1);
    EXPECT_GE(furthest, 0.6);
  }
}

TEST(Resolve, AHeadIsSeenFromTheFrontUpright) {
  const Camera camera = *resolve_scene(bare(), head()).camera;
  const CameraBasis basis = camera_basis(camera);
  EXPECT_GT(basis.forward.y, 0.8);  // towards posterior, +y in LPS
  EXPECT_GT(basis.up.z, 0.8);       // superior is up
  EXPECT_EQ(camera.target, glm::dvec3(0, -18, 18));
}

TEST(Resolve, ASliceIsSeenFromItsFlatSide) {
  VolumeInfo info = head();
  info.geometry.size.z = 1;
  const CameraBasis basis = camera_basis(*resolve_scene(bare(), info).camera);
  EXPECT_NEAR(basis.forward.z, 1, 1e-12);
  EXPECT_NEAR(basis.right.x, 1, 1e-12);  // the subject's left is on the right
}

TEST(Resolve, ASingleVoxelHasACameraToo) {
  VolumeInfo info = head();
  info.geometry.size = {1, 1, 1};
  const Scene scene = resolve_scene(bare(), info);
  EXPECT_FALSE(camera_fault(*scene.camera).any());
  expect_usable(*scene.volumes[0].transfer_function);
}

TEST(DefaultTransferFunction, HidesTheBackgroundAndShowsTissue) {
  const TransferFunction function = default_transfer_function(head());
  EXPECT_EQ(function.opacity_at(0), 0);
  EXPECT_EQ(function.opacity_at(8), 0);
  EXPECT_GT(function.opacity_at(90), 0.05);
  EXPECT_GT(function.opacity_at(255), function.opacity_at(90));
}

TEST(DefaultTransferFunction, LooksTheSameAtEveryScale) {
  VolumeInfo half = head();
  half.geometry.spacing_mm = {0.5, 0.5, 0.5};
  EXPECT_DOUBLE_EQ(default_transfer_function(half).unit_distance_mm,
                   default_transfer_function(head()).unit_distance_mm / 2);
}

TEST(DefaultTransferFunction, FollowsTheValuesOfTheData) {
  VolumeInfo ct = head();
  ct.type = VoxelType::kInt16;
  ct.minimum = -1000;
  ct.maximum = 3080;
  const TransferFunction a = default_transfer_function(head()), b = default_transfer_function(ct);
  for (const double value : {0.0, 20.0, 60.0, 90.0, 200.0}) {
    EXPECT_NEAR(a.opacity_at(value), b.opacity_at(-1000 + value * 16), 1e-12);
  }
}

TEST(DefaultTransferFunction, AConstantOrEmptyVolumeIsAHaze) {
  VolumeInfo info = head();
  info.maximum = info.minimum = 7;
  EXPECT_GT(default_transfer_function(info).opacity_at(7), 0);
  info.histogram.clear();
  info.minimum = info.maximum = 0;
  EXPECT_GT(default_transfer_function(info).opacity_at(0), 0);
  expect_usable(default_transfer_function(info));
}

TEST(DefaultTransferFunction, LabelsGetColoursOfTheirOwn) {
  VolumeInfo info = head();
  info.minimum = 0;
  info.maximum = 5;
  info.histogram.assign(256, 0);
  for (const int label : {0, 1, 3, 5}) {
    info.histogram[static_cast<std::size_t>(std::min(255, label * 256 / 5))] = 1000;
  }
  const TransferFunction function = default_transfer_function(info);
  expect_usable(function);
  EXPECT_EQ(function.opacity_at(0), 0);
  for (const int label : {1, 3, 5}) EXPECT_GT(function.opacity_at(label), 0.1);
  EXPECT_GT(glm::length(function.color_at(1) - function.color_at(3)), 0.2);
  EXPECT_GT(glm::length(function.color_at(3) - function.color_at(5)), 0.2);
}

TEST(DefaultTransferFunction, AnOutlierDoesNotHideTheRest) {
  VolumeInfo info = head();
  info.type = VoxelType::kFloat32;
  info.maximum = 1e6;  // everything but one voxel is in the first bin
  info.histogram.assign(256, 0);
  info.histogram[0] = 1000000;
  info.histogram[255] = 1;
  const TransferFunction function = default_transfer_function(info);
  expect_usable(function);
  EXPECT_GT(function.opacity_at(1e6), 0);
}

TEST(ForegroundThreshold, LiesBetweenTwoPeaks) {
  VolumeInfo info = head();
  info.histogram.assign(256, 0);
  info.histogram[10] = 1000;
  info.histogram[200] = 100;
  EXPECT_GT(foreground_threshold(info), 50);
  EXPECT_LT(foreground_threshold(info), 160);
}

TEST(Resolve, SharesOfTheRangeBecomeDataValues) {
  VolumeInfo info = head();
  info.minimum = -100;
  info.maximum = 300;
  Scene scene = bare();
  scene.volumes[0].transfer_function =
      TransferFunction{1, {{0, {0, 0, 0}}, {1, {1, 1, 1}}}, {{0.5, 0.25}}, true, true};
  const TransferFunction function = *resolve_scene(scene, info).volumes[0].transfer_function;
  EXPECT_EQ(function.color[0].value, -100);
  EXPECT_EQ(function.color[1].value, 300);
  EXPECT_EQ(function.opacity[0].value, 100);
  expect_usable(function);
}

TEST(Resolve, ColoursWithoutOpacityGetTheDefaultOne) {
  Scene scene = bare();
  scene.volumes[0].transfer_function = TransferFunction{1, {{0, {1, 0, 0}}}, {}};
  const TransferFunction function = *resolve_scene(scene, head()).volumes[0].transfer_function;
  EXPECT_EQ(function.opacity, default_transfer_function(head()).opacity);
  EXPECT_EQ(function.color_at(9), glm::dvec3(1, 0, 0));
}

TEST(Resolve, ModeIsosurfaceWithoutOneGetsTheForegrounds) {
  Scene scene = bare();
  scene.volumes[0].mode = Mode::kIsosurface;
  const Scene resolved = resolve_scene(scene, head());
  ASSERT_EQ(resolved.volumes[0].isosurfaces.size(), 1u);
  EXPECT_EQ(resolved.volumes[0].isosurfaces[0].value, foreground_threshold(head()));
}

}  // namespace
}  // namespace goldthread
