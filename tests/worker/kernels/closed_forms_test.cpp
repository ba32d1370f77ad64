// SPDX-License-Identifier: Apache-2.0
// Fields that voxels store exactly and whose picture is known in closed form: what is left is
// rounding to float. Through the real kernels, on every instruction set.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "analytic_fields.h"
#include "every_instruction_set.h"
#include "exact_field.h"

namespace goldthread::test {
namespace {

class ClosedForm : public EveryInstructionSet {};
GOLDTHREAD_ON_EVERY_INSTRUCTION_SET(ClosedForm);

constexpr VoxelType kAllTypes[] = {VoxelType::kUInt8, VoxelType::kInt8, VoxelType::kUInt16,
                                   VoxelType::kInt16, VoxelType::kFloat32};

// A ray ends once no more than this can be seen through what lies before.
constexpr double kUnseen = 1.0 / 1024;

TEST_P(ClosedForm, AConstantSlabIsExactAtAnyStepForEveryTypeOfVoxel) {
  const VolumeGeometry geometry{.size = {9, 9, 33}};
  for (const VoxelType type : kAllTypes) {
    const auto volume = make_volume(geometry, type, [](int, int, int) { return 100; });
    for (const double kappa : {1e-9, 1e-6, 1e-3, 0.05, 0.2, 1.0, 9.0})
      for (const double step : {0.25, 0.37, 1.0, 7.0, 100.0}) {
        TransferFunction function = linear_extinction({{0, kappa}});
        function.color = {{0, {0.5, 0.25, 1}}};
        Scene scene = axial_scene(geometry, function);
        scene.step_mm = step;
        const double expected = -std::expm1(-kappa * 32);
        const Sample found = central_ray(scene, volume);
        const double tolerance =
            expected * roundoff(32 / step) + (1 - expected <= kUnseen ? kUnseen : 0);
        EXPECT_NEAR(found.alpha, expected, tolerance) << name_of(type) << kappa << ' ' << step;
        EXPECT_NEAR(found.red, 0.5 * expected, tolerance) << kappa << ' ' << step;
        EXPECT_NEAR(found.blue, expected, tolerance) << kappa << ' ' << step;
      }
  }
}

TEST_P(ClosedForm, ARampOfExtinctionIsExactAtAnyStep) {
  // α = 1 − e^(−kD²/2): segments whose middle stands for all of them integrate it exactly.
  constexpr double kSlope = 0.004, kLength = 32;
  const auto volume = ramp_along_z(kLength);
  Scene scene = axial_scene(volume->info().geometry, proportional_extinction(kSlope * kLength, 1));
  for (const double step : {0.11, 0.31, 1.0, 3.0, 7.7, 50.0}) {
    scene.step_mm = step;
    const double expected = -std::expm1(-0.5 * kSlope * kLength * kLength);
    EXPECT_NEAR(central_ray(scene, volume).alpha, expected, roundoff(kLength / step)) << step;
  }
}

TEST_P(ClosedForm, NineDecadesOfExtinctionKeepTheirDigits) {
  // τ = κ₀·e^(−t/ℓ), seen across: in each plane of voxels the extinction is constant.
  constexpr int kPlanes = 21;
  const VolumeGeometry geometry{.size = {9, 9, kPlanes}};
  const auto volume =
      make_volume(geometry, VoxelType::kFloat32, [](int, int, int k) { return std::exp(-k); });
  Scene scene = axial_scene(geometry, proportional_extinction(0.4, 1));
  scene.step_mm = 0.3;
  for (int k = 0; k < kPlanes; ++k) {
    scene.camera = Camera{{-30, 4.1, double(k)}, {4, 4.1, double(k)}, {0, 0, 1}, 1};
    const double expected = -std::expm1(-0.4 * volume->at(0, 0, k) * 8);
    // Between two rows of the table opacity is linear, which is off by half a row's: 1.5e-5.
    EXPECT_NEAR(central_ray(scene, volume).alpha / expected, 1, 2e-5) << "e^-" << k;
  }
}

// A trilinear function that 12³ voxels store exactly: whole numbers.
double trilinear(const glm::dvec3& p) {
  return 40 + 3 * p.x - 2 * p.y + 5 * p.z + p.x * p.y - 2 * p.y * p.z + p.x * p.z + p.x * p.y * p.z;
}
glm::dvec3 trilinear_gradient(const glm::dvec3& p) {
  return {3 + p.y + p.z + p.y * p.z, -2 + p.x - 2 * p.z + p.x * p.z, 5 - 2 * p.y + p.x + p.x * p.y};
}
std::shared_ptr<const Volume> trilinear_volume(VoxelType type) {
  return make_volume({.size = {12, 12, 12}}, type, [](int i, int j, int k) {
    return trilinear({i, j, k});
  });
}

// White light along each axis in a colour of its own: a lit sample shows |n|.
std::vector<Light> axis_lights() {
  return {{DirectionalLight{{1, 0, 0}}, 1, {1, 0, 0}},
          {DirectionalLight{{0, 1, 0}}, 1, {0, 1, 0}},
          {DirectionalLight{{0, 0, 1}}, 1, {0, 0, 1}}};
}

// Compares the normals of first hits well inside the volume; the greatest difference.
double worst_normal(const std::shared_ptr<const Volume>& volume, int& compared) {
  const ExactField field(*volume);
  Scene scene = ramp_scene(volume->info());
  scene.lights = axis_lights();
  scene.volumes[0].mode = Mode::kIsosurface;
  scene.volumes[0].shading = Shading{.ambient = 0, .diffuse = 1, .specular = 0};
  scene.step_mm = 0.02;
  double worst = 0;
  for (const double isovalue : {30.0, 77.7, 200.3, 400.9, 600.1}) {
    scene.volumes[0].isosurfaces = {{isovalue, {1, 1, 1}, 1}};
    const auto rays = pixel_centres(scene.image.size);
    const Picture picture = cast(scene, volume, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const IndexRay ray = index_ray(scene, field.geometry(), rays[i]);
      const Crossings found = field.crossings(ray, isovalue);
      if (found.hits.empty() || found.clearance < 1e-3) continue;
      const glm::dvec3 place = ray.at(found.hits.front().t_mm);
      // Differences at the outermost voxels are one-sided.
      if (glm::any(glm::lessThan(place, glm::dvec3(1.1))) ||
          glm::any(glm::greaterThan(place, glm::dvec3(9.9))))
        continue;
      const glm::dvec3 n = glm::abs(glm::normalize(trilinear_gradient(place)));
      const glm::dvec3 seen(picture[i].red, picture[i].green, picture[i].blue);
      worst = std::max(worst, glm::length(seen - n));
      ++compared;
    }
  }
  return worst;
}

TEST_P(ClosedForm, TheNormalOfATrilinearFieldIsItsGradient) {
  int compared = 0;
  EXPECT_LT(worst_normal(trilinear_volume(VoxelType::kFloat32), compared), 2e-5);
  // int16 is interpolated as 32768 + value, where a float is good to 1/256.
  EXPECT_LT(worst_normal(trilinear_volume(VoxelType::kInt16), compared), 1e-3);
  EXPECT_GT(compared, 300);
}

TEST_P(ClosedForm, ATrilinearFieldIsStoredExactlyForEveryTypeOfVoxel) {
  // Looking out of the volume along a way on which the field rises: its greatest value is the last.
  for (const VoxelType type : kAllTypes) {
    const auto rising = [](const glm::dvec3& p) {
      return 1 + p.x + 2 * p.y + p.z + p.x * p.y * p.z;
    };
    const VolumeGeometry geometry{.size = {5, 5, 5}};
    const auto volume = make_volume(geometry, type, [&](int i, int j, int k) {
      return rising({i, j, k});
    });
    const ExactField field(*volume);
    Scene scene = ramp_scene(volume->info());
    scene.volumes[0].mode = Mode::kMip;
    scene.volumes[0].transfer_function->color = {{0, {0, 0, 0}}, {128, {1, 1, 1}}};
    scene.camera = Camera{{0.5, 0.6, 0.7}, {4, 3.7, 4}, {0, 0, 1}, 20};
    const auto rays = pixel_centres(scene.image.size, 3);
    const Picture picture = cast(scene, volume, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const IndexRay ray = index_ray(scene, geometry, rays[i]);
      const CellSpan last = field.spans(ray).back();
      // int16 is interpolated as 32768 + value, where a float is good to 1/256.
      const double digits = type == VoxelType::kInt16 ? 1.0 / 256 : 4e-5;
      EXPECT_NEAR(128 * picture[i].red, field.value(last.cell, ray.at(last.end_mm)), digits)
          << name_of(type);
    }
  }
}

}  // namespace
}  // namespace goldthread::test
