// SPDX-License-Identifier: Apache-2.0
// Fields whose picture is known in closed form, through the real kernels.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "cast_support.h"

namespace goldthread::test {
namespace {

// A box of `edge_mm` seen along +z from `away` in front of it, so that the central ray runs the
// whole edge, offset a little from voxel planes.
Scene axial_scene(const VolumeGeometry& geometry, TransferFunction function) {
  const glm::dvec3 extent = glm::dvec3(geometry.size - 1) * geometry.spacing_mm;
  Scene scene;
  scene.image.size = {8, 8};
  scene.camera = Camera{{0.5 * extent.x + 0.013, 0.5 * extent.y + 0.021, -37.3},
                        {0.5 * extent.x + 0.013, 0.5 * extent.y + 0.021, 0},
                        {0, 1, 0},
                        1};
  SceneVolume volume;
  volume.transfer_function = std::move(function);
  scene.volumes = {volume};
  return scene;
}

Sample central_ray(const Scene& scene, const std::shared_ptr<const Volume>& volume) {
  return cast(scene, volume, {{4, 4}}).front();
}

// Opacity per unit distance of an extinction.
double alpha_of(double extinction) { return -std::expm1(-extinction); }

TEST(ClosedForm, AConstantSlabIsExactAtAnyStep) {
  VolumeGeometry geometry{.size = {9, 9, 33}};
  const auto volume = make_volume(geometry, VoxelType::kUInt8, [](int, int, int) { return 100; });
  for (const double kappa : {1e-6, 1e-3, 0.05, 1.0, 9.0})
    for (const double step : {0.25, 0.37, 1.0, 7.0, 100.0}) {
      Scene scene = axial_scene(
          geometry, {.color = {{0, {0.5, 0.25, 1}}}, .opacity = {{0, alpha_of(kappa)}}});
      scene.step_mm = step;
      const double expected = -std::expm1(-kappa * 32);
      const Sample found = central_ray(scene, volume);
      // What early termination leaves out, and float.
      const double tolerance = 1.0 / 4096 * (kappa * 32 > 8) + 1e-5 * expected;
      EXPECT_NEAR(found.alpha, expected, tolerance) << kappa << ' ' << step;
      EXPECT_NEAR(found.red, 0.5 * expected, tolerance) << kappa << ' ' << step;
      EXPECT_NEAR(found.blue, expected, tolerance) << kappa << ' ' << step;
    }
}

TEST(ClosedForm, AUniformSphereHasTheOpacityOfItsChord) {
  // A linear ramp of values across the surface, made opaque by a step: the boundary is where the
  // distance is R, up to the field's trilinear error.
  constexpr double kRadius = 20, kKappa = 0.05;
  VolumeGeometry geometry{.size = {65, 65, 65}};
  const auto volume = make_volume(geometry, VoxelType::kFloat32, [](int i, int j, int k) {
    return glm::length(glm::dvec3(i, j, k) - 32.0);
  });
  const TransferFunction function{
      .color = {{0, {1, 1, 1}}},
      .opacity = {{0, alpha_of(kKappa)}, {kRadius, alpha_of(kKappa)}, {kRadius, 0}, {100, 0}}};
  Scene scene = axial_scene(geometry, function);
  scene.camera =
      Camera{{32, 32, -1e5}, {32, 32, 32}, {0, 1, 0}, 2 * std::atan(32 / 1e5) * 57.29577951308232};
  scene.image.size = {64, 64};
  scene.step_mm = 0.05;
  for (const double impact : {0.0, 5.3, 11.7, 16.2, 19.0}) {
    const Sample found = cast(scene, volume, {{float(32 + impact), 32}}).front();
    const double expected =
        -std::expm1(-2 * kKappa * std::sqrt(kRadius * kRadius - impact * impact));
    // Trilinear interpolation of |r| is off by up to Σ|f″|/8 = 2/8R; and a segment that the
    // boundary cuts counts in full or not at all.
    const double chord = kRadius / std::sqrt(kRadius * kRadius - impact * impact);
    EXPECT_NEAR(found.alpha, expected, 2 * kKappa * (chord * 0.25 / kRadius + 0.025)) << impact;
  }
  EXPECT_EQ(cast(scene, volume, {{float(32 + 20.6), 32}}).front().alpha, 0);
}

// Values t along z, 0…1 over the volume, as a field of floats.
std::shared_ptr<const Volume> ramp_along_z(const VolumeGeometry& geometry) {
  return make_volume(geometry, VoxelType::kFloat32,
                     [&](int, int, int k) { return double(k) / (geometry.size.z - 1); });
}

double ramp_error(double step) {
  // τ = k·t over D: the transfer function holds α with σ = −ln(1−α), by many nodes.
  constexpr double kSlope = 0.02, kLength = 32;
  VolumeGeometry geometry{.size = {9, 9, 33}};
  TransferFunction function{.color = {{0, {1, 1, 1}}}, .opacity = {}};
  for (int i = 0; i <= 4096; ++i)
    function.opacity.push_back({i / 4096.0, alpha_of(kSlope * kLength * i / 4096.0)});
  Scene scene = axial_scene(geometry, function);
  scene.step_mm = step;
  const double expected = -std::expm1(-0.5 * kSlope * kLength * kLength);
  return std::abs(central_ray(scene, ramp_along_z(geometry)).alpha - expected);
}

TEST(ClosedForm, ARampOfExtinctionIsExactForTheMidpointRule) {
  // The optical depth of a linear extinction is exact at midpoints, whatever the step.
  for (const double step : {0.31, 1.0, 3.0}) EXPECT_LT(ramp_error(step), 1e-3) << step;
}

double color_error(double step) {
  constexpr double kKappa = 0.05, kLength = 32, kDepth = kKappa * kLength;
  VolumeGeometry geometry{.size = {9, 9, 33}};
  Scene scene = axial_scene(
      geometry, {.color = {{0, {0, 0, 0}}, {1, {1, 1, 1}}}, .opacity = {{0, alpha_of(kKappa)}}});
  scene.step_mm = step;
  const double expected = (1 - (1 + kDepth) * std::exp(-kDepth)) / kDepth;
  return std::abs(central_ray(scene, ramp_along_z(geometry)).red - expected);
}

TEST(ClosedForm, ARampOfColourConvergesWithTheSquareOfTheStep) {
  // Steps in the ratio 2; the fitted order is printed with the errors that it came from.
  const std::array<double, 3> steps{8, 4, 2};
  std::array<double, 3> errors{};
  for (std::size_t i = 0; i < steps.size(); ++i) errors[i] = color_error(steps[i]);
  const double order = std::log2(errors[0] / errors[2]) / 2;
  std::printf("  errors %.3e %.3e %.3e, order %.2f\n", errors[0], errors[1], errors[2], order);
  EXPECT_GT(order, 1.7);
  EXPECT_LT(errors[2], 1e-3);
}

}  // namespace
}  // namespace goldthread::test
