// SPDX-License-Identifier: Apache-2.0
// Hard cases of values: voxels that are no numbers, huge and tiny ones, constant and empty volumes,
// isovalues and transfer functions at their limits. On every instruction set.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "analytic_fields.h"
#include "every_instruction_set.h"

namespace goldthread::test {
namespace {

class HardValue : public EveryInstructionSet {};
GOLDTHREAD_ON_EVERY_INSTRUCTION_SET(HardValue);

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDenormal = 1e-42;  // of float

std::shared_ptr<const Volume> float_volume(const FieldFunction& field) {
  return make_volume({.size = {9, 9, 33}}, VoxelType::kFloat32, field);
}

// Every mode, lit and not, looking along +z through the middle.
std::vector<std::pair<std::string, Scene>> scenes_along_z(const VolumeInfo& info) {
  TransferFunction function = linear_extinction({{0, 0.05}});
  function.color = {{0, {1, 0.5, 0.25}}};
  Scene dvr = axial_scene(info.geometry, function);
  dvr.step_mm = 0.25;
  Scene surface = dvr, mip = dvr;
  surface.volumes[0].mode = Mode::kIsosurface;
  surface.volumes[0].isosurfaces = {{100, {0.9, 0.8, 0.7}, 0.6}};
  mip.volumes[0].mode = Mode::kMip;
  Scene both = surface;
  both.volumes[0].mode = Mode::kDvr;
  std::vector<std::pair<std::string, Scene>> scenes{
      {"dvr", dvr}, {"isosurface", surface}, {"both", both}, {"mip", mip}};
  for (Scene scene : {dvr, surface, both}) {
    scene.volumes[0].shading = Shading{};
    scene.lights = {{Headlight{}}, {PointLight{{4, 4, 10}}, 0.5, {1, 1, 1}}};
    scenes.emplace_back("lit " + scenes[scenes.size() - 4].first, scene);
  }
  return scenes;
}

// ---------------------------------------------------------------------------------------- bad
// voxels

TEST_P(HardValue, ACellWithABadVoxelIsEmptyAndItsNeighboursAreNot) {
  // Each bad plane of voxels takes two cells away; the segments end on the planes.
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    const auto volume =
        float_volume([&](int, int, int k) { return k == 7 || k == 8 || k == 20 ? bad : 50.0; });
    Scene scene = axial_scene(volume->info().geometry, linear_extinction({{0, 0.05}}));
    scene.camera->position.z = -40;
    scene.step_mm = 0.25;
    const double expected = -std::expm1(-0.05 * (32 - 3 - 2));
    EXPECT_NEAR(central_ray(scene, volume).alpha, expected, roundoff(128)) << bad;
  }
}

TEST_P(HardValue, OneBadVoxelEmptiesTheEightCellsAroundIt) {
  const auto volume =
      float_volume([](int i, int j, int k) { return i == 4 && j == 4 && k == 16 ? kNan : 50.0; });
  Scene scene = axial_scene(volume->info().geometry, linear_extinction({{0, 0.05}}));
  scene.camera->position.z = -40;
  scene.step_mm = 0.25;
  for (const double x : {2.5, 3.5, 4.5, 5.5})
    for (const double y : {2.5, 3.5, 4.5, 5.5}) {
      scene.camera->position.x = scene.camera->target.x = x;
      scene.camera->position.y = scene.camera->target.y = y;
      const bool touched = std::abs(x - 4) < 1 && std::abs(y - 4) < 1;
      EXPECT_NEAR(central_ray(scene, volume).alpha, -std::expm1(-0.05 * (touched ? 30 : 32)),
                  roundoff(128))
          << x << ' ' << y;
    }
}

TEST_P(HardValue, AVolumeWithoutAnyNumberIsEmpty) {
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    const auto volume = float_volume([&](int, int, int) { return bad; });
    for (const auto& [name, scene] : scenes_along_z(volume->info()))
      for (const Sample& sample : cast(scene, volume, pixel_centres(scene.image.size)))
        EXPECT_EQ(sample, Sample{}) << name << ' ' << bad;
  }
}

TEST_P(HardValue, NoSurfaceLiesBetweenANumberAndABadVoxel) {
  // 50 below the plane of bad voxels, 150 above: nowhere is there a finite cell that crosses 100.
  const auto volume =
      float_volume([](int, int, int k) { return k < 15 ? 50.0 : (k == 15 ? kNan : 150.0); });
  for (const auto& [name, scene] : scenes_along_z(volume->info())) {
    if (name != "isosurface" && name != "lit isosurface") continue;
    for (const double step : {0.1, 0.5, 1.9}) {
      Scene other = scene;
      other.step_mm = step;
      EXPECT_EQ(central_ray(other, volume), Sample{}) << name << ' ' << step;
    }
  }
}

TEST_P(HardValue, HugeTinyAndDenormalVoxelsGiveSaneSamples) {
  const double palette[] = {3.4e38, -3.4e38, 1e38,      1e-38, kDenormal, -kDenormal,
                            0,      -0.0,    kInfinity, kNan,  1,         -1e-30};
  for (int shift = 0; shift < 12; ++shift) {
    const auto volume = float_volume([&](int i, int j, int k) {
      return palette[std::size_t((i * 7 + j * 5 + k * 3 + shift * (1 + k / 8)) % 12)];
    });
    for (auto [name, scene] : scenes_along_z(volume->info())) {
      for (const double isovalue : {0.0, 1e-40, 1e37}) {
        if (!scene.volumes[0].isosurfaces.empty()) scene.volumes[0].isosurfaces[0].value = isovalue;
        cast(scene, volume, pixel_centres(scene.image.size));
      }
    }
  }
}

TEST_P(HardValue, DenormalVoxelsCountAsNearlyZero) {
  const auto volume = float_volume([](int i, int j, int k) { return kDenormal * (i + j + k); });
  TransferFunction function = linear_extinction({{-1, 0}, {1, 0.1}});
  const Scene scene = axial_scene(volume->info().geometry, function);
  EXPECT_NEAR(central_ray(scene, volume).alpha, -std::expm1(-0.05 * 32), 1e-5);
}

// --------------------------------------------------------------------------------- constant
// volumes

TEST_P(HardValue, AConstantVolumeHasNoSurfaceAndNoNormal) {
  for (const double value : {0.0, 100.0, -5e8}) {
    const auto volume = float_volume([&](int, int, int) { return value; });
    for (auto [name, scene] : scenes_along_z(volume->info())) {
      if (!scene.volumes[0].isosurfaces.empty()) scene.volumes[0].isosurfaces[0].value = value;
      const Sample found = central_ray(scene, volume);
      const bool lit = scene.volumes[0].shading.has_value();
      const bool absorbs = scene.volumes[0].mode == Mode::kDvr;
      const double alpha = name == "mip" ? 1 : (absorbs ? -std::expm1(-0.05 * 32) : 0);
      EXPECT_NEAR(found.alpha, alpha, roundoff(128)) << name << ' ' << value;
      // Where the gradient vanishes the ambient term alone remains.
      EXPECT_NEAR(found.red, alpha * (lit ? Shading{}.ambient : 1), roundoff(128)) << name;
    }
  }
}

// ----------------------------------------------------------------------------------------
// isovalues

TEST_P(HardValue, IsovaluesBeyondTheDatasRangeShowNothing) {
  const auto volume = float_volume([](int, int, int k) { return double(k); });
  for (auto [name, scene] : scenes_along_z(volume->info())) {
    if (scene.volumes[0].mode != Mode::kIsosurface) continue;
    for (const double isovalue : {-1e30, -1e-3, 32.001, 1e30, 3.4e38}) {
      scene.volumes[0].isosurfaces[0].value = isovalue;
      EXPECT_EQ(central_ray(scene, volume), Sample{}) << name << ' ' << isovalue;
    }
  }
}

TEST_P(HardValue, SurfacesOfOneValueAreMetInTheOrderOfTheScene) {
  // As if their values rose a little from one to the next: from the other side, in reverse.
  const auto volume = float_volume([](int, int, int k) { return double(k); });
  Scene scene = axial_scene(volume->info().geometry, linear_extinction({{0, 0.05}}));
  scene.volumes[0].mode = Mode::kIsosurface;
  scene.volumes[0].isosurfaces = {{10.5, {1, 0, 0}, 0.5}, {10.5, {0, 1, 0}, 0.5}};
  EXPECT_EQ(central_ray(scene, volume), (Sample{0.5, 0.25, 0, 0.75}));
  scene.camera->position.z = 70;
  EXPECT_EQ(central_ray(scene, volume), (Sample{0.25, 0.5, 0, 0.75}));
}

TEST_P(HardValue, AnIsosurfaceOfOpacityZeroShowsNothing) {
  const auto volume = float_volume([](int, int, int k) { return double(k); });
  Scene scene = axial_scene(volume->info().geometry, linear_extinction({{0, 0.05}}));
  scene.volumes[0].mode = Mode::kIsosurface;
  scene.volumes[0].isosurfaces = {{10.5, {1, 1, 1}, 0}};
  EXPECT_EQ(central_ray(scene, volume), Sample{});
}

// -------------------------------------------------------------------------------- transfer
// functions

TEST_P(HardValue, AStepOfTheTransferFunctionHoldsItsLaterNode) {
  // On a plateau of exactly the step's value; integers need no table between them.
  const auto volume = make_volume({.size = {9, 9, 33}}, VoxelType::kUInt8,
                                  [](int, int, int k) { return k < 16 ? 80 : 40; });
  TransferFunction function = linear_extinction({{0, 0.05}});
  const double alpha = function.opacity.front().alpha;
  function.opacity = {{0, 0}, {80, 0}, {80, alpha}, {255, alpha}};
  Scene scene = axial_scene(volume->info().geometry, function);
  scene.camera->position.z = -40;
  scene.step_mm = 0.25;
  // 15 cells hold 80; the cell that falls to 40 is empty but for the table's row below the step.
  EXPECT_NEAR(central_ray(scene, volume).alpha, -std::expm1(-0.05 * 15), 5e-4);
}

TEST_P(HardValue, StepsAtTheFirstAndLastNodeHoldOnBothSides) {
  // Below the first node its earlier value is constant, above the last its later one; in segments
  // of full length, and in parts of one.
  const auto volume = float_volume([](int, int, int k) { return double(k); });
  TransferFunction function = linear_extinction({{28, 0.05}});
  const double alpha = function.opacity.front().alpha;
  Scene scene = axial_scene(volume->info().geometry, function);
  const auto expect_depth = [&](const std::vector<OpacityNode>& nodes, double length) {
    scene.volumes[0].transfer_function->opacity = nodes;
    scene.step_mm = 0.01;
    // A segment and a row of the table.
    EXPECT_NEAR(central_ray(scene, volume).alpha, -std::expm1(-0.05 * length),
                0.05 * (0.01 + 32.0 / 4096))
        << length;
  };
  expect_depth({{10, 0}, {10, alpha}}, 22);
  expect_depth({{10, alpha}, {10, 0}}, 10);
  expect_depth({{10, 0}, {10, alpha}, {25, alpha}, {25, 0}}, 15);
  expect_depth({{10, alpha}, {10, 0}, {25, 0}, {25, alpha}}, 17);
  // One part of a segment, with all its values below the first node.
  scene.volumes[0].transfer_function->opacity = {{40, 0}, {40, alpha}};
  scene.step_mm = 100;
  EXPECT_EQ(central_ray(scene, volume), Sample{});
  scene.volumes[0].transfer_function->opacity = {{20, 0}, {20, alpha}};
  scene.camera->position.z = -30;
  EXPECT_EQ(central_ray(scene, volume), Sample{});
}

TEST_P(HardValue, AStepOfColourAtTheFirstNodeHoldsOnBothSides) {
  const auto volume = float_volume([](int, int, int k) { return double(k); });
  Scene scene = axial_scene(volume->info().geometry, linear_extinction({{28, 0.05}}));
  scene.volumes[0].transfer_function->color = {{10, {1, 0, 0}}, {10, {0, 1, 0}}};
  scene.step_mm = 0.01;
  const Sample found = central_ray(scene, volume);
  EXPECT_NEAR(found.red, -std::expm1(-0.05 * 10), 1e-3);
  EXPECT_NEAR(found.green, std::exp(-0.05 * 10) * -std::expm1(-0.05 * 22), 1e-3);
}

TEST_P(HardValue, AJumpFromTransparentToOpaqueHidesWhatLiesBehind) {
  const auto volume = float_volume([](int, int, int k) { return double(k); });
  Scene scene = axial_scene(volume->info().geometry,
                            {.color = {{0, {1, 0, 0}}, {20, {1, 0, 0}}, {20, {0, 1, 0}}},
                             .opacity = {{0, 0}, {12, 0}, {12, 1}}});
  for (const double step : {0.1, 1.0, 3.0}) {
    scene.step_mm = step;
    const Sample found = central_ray(scene, volume);
    EXPECT_NEAR(found.red, 1, 1.0 / 1024) << step;
    EXPECT_NEAR(found.green, 0, 1.0 / 1024) << step;
    EXPECT_NEAR(found.alpha, 1, 1.0 / 1024) << step;
  }
}

TEST_P(HardValue, OpacityZeroEverywhereIsTheBackgroundInEveryBit) {
  const auto volume = float_volume([](int i, int j, int k) { return double(i * j - k); });
  for (auto [name, scene] : scenes_along_z(volume->info())) {
    if (name != "dvr" && name != "lit dvr") continue;
    scene.volumes[0].transfer_function->opacity = {{-50, 0}, {50, 0}};
    for (const Sample& sample : cast(scene, volume, pixel_centres(scene.image.size)))
      EXPECT_EQ(sample, Sample{}) << name;
  }
}

TEST_P(HardValue, NodesOutsideTheDatasRangeCountAsFarAsTheyReachIn) {
  // The data hold 0…32; opacity rises from −1000 to 1000 and is a half of its height in the middle.
  const auto volume = float_volume([](int, int, int k) { return double(k); });
  const Scene scene =
      axial_scene(volume->info().geometry, linear_extinction({{-1000, 0}, {1000, 0.1}}));
  const double depth = 32 * 0.1 * (1000 + 16) / 2000;
  EXPECT_NEAR(central_ray(scene, volume).alpha, -std::expm1(-depth), 1e-5);
}

}  // namespace
}  // namespace goldthread::test
