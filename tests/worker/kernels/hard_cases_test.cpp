// SPDX-License-Identifier: Apache-2.0
// Hard cases of sampling: many and tiny steps, far and huge worlds, rays that run along what others
// cross, stretched and sheared grids. On every instruction set.

#include <gtest/gtest.h>

#include <cmath>

#include "analytic_fields.h"
#include "every_instruction_set.h"
#include "exact_field.h"

namespace goldthread::test {
namespace {

class HardCase : public EveryInstructionSet {};
GOLDTHREAD_ON_EVERY_INSTRUCTION_SET(HardCase);

std::shared_ptr<const Volume> constant_volume(const VolumeGeometry& geometry) {
  return make_volume(geometry, VoxelType::kUInt8, [](int, int, int) { return 100; });
}

double wave(int i, int j, int k) {
  return 60 + 50 * std::sin(0.7 * i + 0.2 * k) * std::cos(0.5 * j) * std::cos(0.4 * k);
}

// Scenes of each mode, and lit ones.
std::vector<std::pair<std::string, Scene>> all_modes(const VolumeInfo& info) {
  Scene dvr = ramp_scene(info);
  Scene surface = dvr, mip = dvr;
  surface.volumes[0].mode = Mode::kIsosurface;
  surface.volumes[0].isosurfaces = {{70, {0.9, 0.8, 0.7}, 0.6}};
  mip.volumes[0].mode = Mode::kMip;
  std::vector<std::pair<std::string, Scene>> scenes{
      {"dvr", dvr}, {"isosurface", surface}, {"mip", mip}};
  for (Scene scene : {dvr, surface}) {
    scene.volumes[0].shading = Shading{};
    scenes.emplace_back("lit " + scenes[scenes.size() - 3].first, scene);
  }
  return scenes;
}

// ------------------------------------------------------------------------------- opacity
// correction

TEST_P(HardCase, OpacityIsCorrectedWithAllItsDigits) {
  // 1 − (1−a)^r by −expm1(r·log1p(−a)): the naive form loses every digit at r = 1e-6.
  const VolumeGeometry geometry{.size = {9, 9, 9}};
  const auto volume = constant_volume(geometry);
  for (const double a : {1e-7, 1e-4, 0.01, 0.5, 0.999})
    for (const double unit : {8e2, 8e4, 8e6, 8e8})
      for (const double step : {100.0, 8.0, 1.7, 0.25}) {
        Scene scene = axial_scene(
            geometry, {.unit_distance_mm = unit, .color = {{0, {1, 1, 1}}}, .opacity = {{0, a}}});
        scene.step_mm = step;
        const double expected = -std::expm1(8 / unit * std::log1p(-a));
        EXPECT_NEAR(central_ray(scene, volume).alpha / expected, 1, roundoff(8 / step))
            << a << ' ' << unit << ' ' << step;
      }
}

TEST_P(HardCase, OpacityOneIsCappedAtOneMinusAMillionth) {
  // Over a tenth of the unit distance 1 − 1e-6 leaves 1e-6^0.1 = 25 %.
  const VolumeGeometry geometry{.size = {9, 9, 9}};
  const auto volume = constant_volume(geometry);
  for (const double step : {8.0, 1.7, 0.25}) {
    Scene scene = axial_scene(
        geometry, {.unit_distance_mm = 80, .color = {{0, {1, 1, 1}}}, .opacity = {{0, 1}}});
    scene.step_mm = step;
    EXPECT_NEAR(central_ray(scene, volume).alpha, 1 - std::pow(1e-6, 0.1), roundoff(8 / step));
  }
}

// ---------------------------------------------------------------------------------------- many
// steps

TEST_P(HardCase, ManyStepsAddUpToWhatOneGives) {
  // Optical depth 1 in up to half a million steps. Float sums of so many drift: T·(1−a) a hundred
  // thousand times is off by 3.6e-4.
  const VolumeGeometry geometry{.size = {3, 3, 33}};
  const auto volume = constant_volume(geometry);
  TransferFunction function = linear_extinction({{0, 1.0 / 32}});
  function.color = {{0, {1, 0.5, 0.25}}};
  Scene scene = axial_scene(geometry, function);
  const double expected = -std::expm1(-1);
  for (const double steps : {1e3, 1e4, 1e5, 5e5}) {
    scene.step_mm = 32 / steps;
    const Sample found = central_ray(scene, volume);
    std::printf("  %7.0f steps: off by %.1e\n", steps, found.alpha - expected);
    EXPECT_NEAR(found.alpha, expected, 1e-4) << steps;
    EXPECT_NEAR(found.green, 0.5 * expected, 1e-4) << steps;
  }
}

TEST_P(HardCase, PositionsDoNotDriftOverManySteps) {
  // The place of a jump, after a hundred thousand steps: its optical depth tells where it was seen.
  const VolumeGeometry geometry{.size = {3, 3, 33}};
  const auto volume =
      make_volume(geometry, VoxelType::kUInt8, [](int, int, int k) { return 7 * k; });
  TransferFunction function = linear_extinction({{0, 1.0 / 8}});
  const double alpha = function.opacity.front().alpha;
  function.opacity = {{0, 0}, {168, 0}, {168, alpha}, {224, alpha}};
  Scene scene = axial_scene(geometry, function);
  scene.step_mm = 32 / 1e5;
  // The table joins rows 1/16 of a value apart: the jump lies within 1/112 mm.
  EXPECT_NEAR(central_ray(scene, volume).alpha, -std::expm1(-1), std::exp(-1) / 8 * 0.01);
}

TEST_P(HardCase, AStepTooSmallToCountIsRaisedInsteadOfHanging) {
  const VolumeGeometry geometry{.size = {9, 9, 9}};
  const auto volume = constant_volume(geometry);
  Scene scene = axial_scene(geometry, linear_extinction({{0, 0.1}}));
  scene.step_mm = 1e-300;
  EXPECT_NEAR(central_ray(scene, volume).alpha, -std::expm1(-0.8), 1e-3);
}

// ------------------------------------------------------------------------------------ large and
// far

TEST_P(HardCase, AWorldScaledByAPowerOfTwoGivesTheSameBits) {
  const VolumeGeometry small{.size = {13, 11, 9}, .spacing_mm = {1, 1.25, 0.5}};
  const auto here = make_volume(small, VoxelType::kUInt8, wave);
  for (const double factor : {0x1p-20, 0x1p20}) {
    VolumeGeometry scaled = small;
    scaled.spacing_mm *= factor;
    const auto there = make_volume(scaled, VoxelType::kUInt8, wave);
    for (const auto& [name, scene] : all_modes(here->info())) {
      Scene larger = scene;
      larger.camera->position *= factor;
      larger.camera->target *= factor;
      larger.volumes[0].transfer_function->unit_distance_mm *= factor;
      const auto rays = pixel_centres(scene.image.size);
      EXPECT_TRUE(same_bits(cast(scene, here, rays), cast(larger, there, rays)))
          << name << ' ' << factor;
    }
  }
}

TEST_P(HardCase, ACameraTenThousandVolumesAwaySeesTheSameRays) {
  // The same lines through the volume, from near and from very far.
  const VolumeGeometry geometry{.size = {13, 11, 9}};
  const auto volume = make_volume(geometry, VoxelType::kUInt8, wave);
  for (const auto& [name, near] : all_modes(volume->info())) {
    Scene scene = near;
    scene.step_mm = 0.05;
    scene.lights = {{DirectionalLight{{1, 2, -1}}}};
    const glm::dvec3 way = glm::normalize(near.camera->target - near.camera->position);
    for (const double back : {1e3, 1e5, 1e7}) {
      Scene far = scene;
      far.camera->position = near.camera->target - way * back;
      const Distance found =
          distance(cast(scene, volume, {{16, 16}}), cast(far, volume, {{16, 16}}));
      // Segments begin elsewhere: what is left is the error of the step.
      EXPECT_LT(found.greatest, 0.3) << name << ' ' << back;
    }
  }
}

// ---------------------------------------------------------------- along axes, faces, edges,
// corners

// A ray through two points of index space, in mm = voxels, against the reference.
void expect_reference(const std::shared_ptr<const Volume>& volume, glm::dvec3 from, glm::dvec3 to,
                      const char* what) {
  for (auto& [name, scene] : all_modes(volume->info())) {
    const glm::dvec3 way = glm::normalize(to - from);
    const glm::dvec3 up = std::abs(way.z) > 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    scene.camera = Camera{from, to, up, 30};
    scene.step_mm = 0.05;
    const std::vector<PixelPosition> centre{{16, 16}};
    const Distance found =
        distance(cast(scene, volume, centre), reference_picture(scene, *volume, centre, 32));
    EXPECT_LT(found.greatest, 0.5)
        << what << ' ' << name << " from " << from.x << ' ' << from.y << ' ' << from.z;
  }
}

TEST_P(HardCase, RaysInCellFacesAndAlongCellEdgesAreTheReferences) {
  const auto volume = make_volume({.size = {9, 9, 9}}, VoxelType::kUInt8, wave);
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      // Both other coordinates whole: along an edge; one of them: in a face; on the border too.
      for (const glm::dvec2& at : {glm::dvec2(3, 4), glm::dvec2(3, 4.4), glm::dvec2(0, 0),
                                   glm::dvec2(8, 8), glm::dvec2(0, 3.3), glm::dvec2(8, 3.3)}) {
        glm::dvec3 from, to;
        from[axis] = 4 - sign * 20, to[axis] = 4;
        from[(axis + 1) % 3] = to[(axis + 1) % 3] = at.x;
        from[(axis + 2) % 3] = to[(axis + 2) % 3] = at.y;
        expect_reference(volume, from, to, "along an axis");
      }
      // Diagonally inside a face.
      glm::dvec3 from(4 - sign * 12), to(4);
      from[axis] = to[axis] = 3;
      expect_reference(volume, from, to, "in a face");
    }
}

TEST_P(HardCase, RaysThroughCornersAreTheReferences) {
  const auto volume = make_volume({.size = {9, 9, 9}}, VoxelType::kUInt8, wave);
  for (int octant = 0; octant < 8; ++octant) {
    const glm::dvec3 sign(octant & 1 ? 1 : -1, octant & 2 ? 1 : -1, octant & 4 ? 1 : -1);
    expect_reference(volume, glm::dvec3(4) + 10.0 * sign, glm::dvec3(4), "diagonal");
    // Through voxel (3, 4, 5) from elsewhere.
    expect_reference(volume, glm::dvec3(3, 4, 5) + sign * glm::dvec3(14, 21, 7), {3, 4, 5},
                     "through a voxel");
  }
}

TEST_P(HardCase, RaysThatTouchTheVolumeInOneEdgeOrCornerShowNothing) {
  const auto volume = constant_volume({.size = {9, 9, 9}});
  for (auto& [name, scene] : all_modes(volume->info())) {
    scene.volumes[0].transfer_function->opacity = {{0, 0.9}};
    // Past the edge x = 0, y = 8, then past the corner (0, 0, 0).
    for (const Camera& camera : {Camera{{-8, 0, 4}, {0, 8, 4}, {0, 0, 1}, 30},
                                 Camera{{-2, 1, 1}, {0, 0, 0}, {0, 0, 1}, 30}}) {
      scene.camera = camera;
      const Sample found = cast(scene, volume, {{16, 16}}).front();
      if (name == "mip") {
        EXPECT_TRUE(found.alpha == 0 || found.alpha == 1) << name;
      } else {
        EXPECT_LT(found.alpha, 1e-5) << name;
      }
    }
  }
}

TEST_P(HardCase, RaysJustOutsideAFaceMissIt) {
  const auto volume = constant_volume({.size = {9, 9, 9}});
  for (auto& [name, scene] : all_modes(volume->info()))
    for (const double y : {-1e-9, 8 + 1e-9}) {
      scene.camera = Camera{{-8, y, 4}, {4, y, 4}, {0, 0, 1}, 30};
      EXPECT_EQ(cast(scene, volume, {{16, 16}}).front(), Sample{}) << name << ' ' << y;
    }
}

// ------------------------------------------------------------------------------- camera inside

TEST_P(HardCase, ACameraInsideOnAFaceOnAVoxelAndOnACornerSeesTheReference) {
  const auto volume = make_volume({.size = {9, 9, 9}}, VoxelType::kUInt8, wave);
  const glm::dvec3 places[] = {{4.3, 3.7, 5.1}, {4, 4, 4}, {0, 3.3, 4.1}, {8, 3.3, 4.1},
                               {3, 0, 4},       {0, 0, 0}, {8, 8, 8},     {0, 8, 4.5}};
  for (const glm::dvec3& place : places)
    for (const glm::dvec3& target : {glm::dvec3(4.1, 4.2, 3.9), glm::dvec3(4, 4, 20)}) {
      for (auto& [name, scene] : all_modes(volume->info())) {
        scene.camera = Camera{place, target, {0.1, 1, 0.2}, 70};
        scene.step_mm = 0.02;
        const auto rays = pixel_centres(scene.image.size, 5);
        const Distance found =
            distance(cast(scene, volume, rays), reference_picture(scene, *volume, rays, 32));
        EXPECT_LT(found.greatest, 1) << name << ' ' << place.x << ' ' << place.y << ' ' << place.z;
      }
    }
}

TEST_P(HardCase, ACameraOnTheFaceThatLooksAwaySeesTheBackground) {
  const auto volume = constant_volume({.size = {9, 9, 9}});
  for (auto& [name, scene] : all_modes(volume->info())) {
    scene.camera = Camera{{4, 4, 0}, {4, 4, -5}, {0, 1, 0}, 60};
    for (const Sample& sample : cast(scene, volume, pixel_centres(scene.image.size, 4)))
      EXPECT_EQ(sample, Sample{}) << name;
  }
}

// ------------------------------------------------------------------- stretched and sheared grids

TEST_P(HardCase, VoxelsStretchedAThousandfoldAreTheReferences) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double stretch : {1000.0, 0.001}) {
      VolumeGeometry geometry{.size = {9, 8, 7}};
      geometry.spacing_mm[axis] = stretch;
      const auto volume = make_volume(geometry, VoxelType::kUInt8, wave);
      for (auto& [name, scene] : all_modes(volume->info())) {
        scene.volumes[0].transfer_function->unit_distance_mm = std::max(1.0, 0.2 * stretch);
        scene.step_mm = stretch > 1 ? 1 : 2e-4;
        const auto rays = pixel_centres(scene.image.size, 5);
        const Distance found =
            distance(cast(scene, volume, rays), reference_picture(scene, *volume, rays, 64));
        EXPECT_LT(found.rms, 1) << name << ' ' << axis << ' ' << stretch;
      }
    }
}

TEST_P(HardCase, NormalsOfSheared1To1000GridsAreThoseOfTheWorld) {
  // A field that is linear in the world: each normal is its gradient, however the grid lies.
  const glm::dmat3 shears[] = {glm::dmat3(1), glm::dmat3(1, 0, 0, 0.6, 0.8, 0, 0, 0.6, 0.8),
                               glm::dmat3(0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6)};
  const glm::dvec3 n = glm::normalize(glm::dvec3(0.2, -0.5, 0.7));
  for (const glm::dmat3& direction : shears)
    for (const glm::dvec3& spacing : {glm::dvec3(1, 1, 1000), glm::dvec3(1000, 1, 1)}) {
      const VolumeGeometry geometry{
          .size = {9, 9, 9}, .spacing_mm = spacing, .origin_mm = {3, 4, 5}, .direction = direction};
      const glm::dmat4 map = geometry.world_from_index();
      const auto volume = make_volume(geometry, VoxelType::kFloat32, [&](int i, int j, int k) {
        return glm::dot(n, glm::dvec3(map * glm::dvec4(i, j, k, 1)));
      });
      Scene scene = ramp_scene(volume->info());
      const glm::dvec3 centre(map * glm::dvec4(4.2, 4.1, 4.3, 1));
      scene.camera = Camera{centre - n * 0.3, centre, {0.3, 1, 0.1}, 1};
      scene.volumes[0].mode = Mode::kIsosurface;
      scene.volumes[0].isosurfaces = {{glm::dot(n, centre), {1, 1, 1}, 1}};
      scene.volumes[0].shading = Shading{.ambient = 0, .diffuse = 1, .specular = 0};
      scene.lights = {{DirectionalLight{{1, 0, 0}}, 1, {1, 0, 0}},
                      {DirectionalLight{{0, 1, 0}}, 1, {0, 1, 0}},
                      {DirectionalLight{{0, 0, 1}}, 1, {0, 0, 1}}};
      scene.step_mm = 0.01;
      const Sample found = cast(scene, volume, {{16, 16}}).front();
      EXPECT_NEAR(found.red, std::abs(n.x), 1e-3) << spacing.x;
      EXPECT_NEAR(found.green, std::abs(n.y), 1e-3) << spacing.x;
      EXPECT_NEAR(found.blue, std::abs(n.z), 1e-3) << spacing.x;
    }
}

}  // namespace
}  // namespace goldthread::test
