// SPDX-License-Identifier: Apache-2.0
// Laws that hold for every kernel: rays depend on themselves alone, instruction sets agree, hard
// rays and bad voxels do no harm.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "cast_support.h"
#include "every_instruction_set.h"
#include "worker/kernels/kernel_table.h"

namespace goldthread::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double blobs(int i, int j, int k) {
  const auto bump = [&](double x, double y, double z, double r) {
    const double d = glm::length(glm::dvec3(i, j, k) - glm::dvec3(x, y, z)) / r;
    return std::exp(-d * d);
  };
  return 200 * bump(9, 12, 10, 6) + 180 * bump(25, 20, 18, 7) + 40 * bump(14, 27, 8, 9);
}

std::shared_ptr<const Volume> blob_volume(VoxelType type = VoxelType::kUInt8) {
  return make_volume({.size = {37, 33, 29}, .spacing_mm = {1, 1.1, 1.3}}, type,
                     [](int i, int j, int k) { return 0.5 * blobs(i, j, k); });
}

// The scenes that between them use every kernel of a kind of voxel.
std::vector<std::pair<std::string, Scene>> scenes_of_all_kernels(const VolumeInfo& info) {
  Scene dvr = ramp_scene(info);
  dvr.volumes[0].transfer_function->opacity = {{info.minimum, 0}, {20, 0}, {60, 0.3}, {90, 0.1}};
  Scene surfaces = dvr;
  surfaces.volumes[0].mode = Mode::kIsosurface;
  surfaces.volumes[0].isosurfaces = {{40, {0.9, 0.8, 0.7}, 0.4}, {70, {0.3, 0.9, 0.2}, 1}};
  Scene both = surfaces;
  both.volumes[0].mode = Mode::kDvr;
  Scene mip = dvr;
  mip.volumes[0].mode = Mode::kMip;
  std::vector<std::pair<std::string, Scene>> scenes{
      {"dvr", dvr}, {"isosurfaces", surfaces}, {"both", both}, {"mip", mip}};
  for (Scene scene : {dvr, surfaces, both}) {
    scene.volumes[0].shading = Shading{};
    scene.lights = {{Headlight{}, 0.8, {1, 1, 1}},
                    {DirectionalLight{{1, 2, -0.5}}, 0.5, {1, 0.5, 0.3}},
                    {PointLight{{100, -20, 60}}, 0.6, {0.2, 0.4, 1}}};
    scenes.emplace_back("shaded " + scenes[scenes.size() - 4].first, scene);
  }
  return scenes;
}

class OnEveryInstructionSet : public EveryInstructionSet {};
GOLDTHREAD_ON_EVERY_INSTRUCTION_SET(OnEveryInstructionSet);

TEST_P(OnEveryInstructionSet, IsTheOneThatRuns) { EXPECT_EQ(instruction_set(), GetParam()); }

TEST_P(OnEveryInstructionSet, AgreesWithTheReferenceForAllKernels) {
  for (const VoxelType type : {VoxelType::kUInt8, VoxelType::kInt16, VoxelType::kFloat32}) {
    const auto volume = blob_volume(type);
    for (auto& [name, scene] : scenes_of_all_kernels(volume->info())) {
      scene.step_mm = 0.1;
      const auto positions = pixel_centres(scene.image.size);
      const Picture picture = cast(scene, volume, positions);
      EXPECT_TRUE(is_sane(picture)) << name;
      const Distance found = distance(picture, reference_picture(scene, *volume, positions, 24));
      EXPECT_LT(found.rms, 0.1) << name << ' ' << name_of(type);
      EXPECT_LT(found.greatest, 3) << name << ' ' << name_of(type);
    }
  }
}

TEST_P(OnEveryInstructionSet, GivesEachRayTheSameBitsInAnyCompany) {
  const auto volume = blob_volume();
  for (const auto& [name, scene] : scenes_of_all_kernels(volume->info())) {
    const auto positions = pixel_centres(scene.image.size);
    const auto source =
        make_ray_caster(commit_scene(scene, volume), *scene.camera, scene.image.size);
    Picture whole(positions.size());
    std::vector<std::uint32_t> whole_met(positions.size());
    source->cast(positions, whole, whole_met);
    std::vector<std::size_t> order(positions.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::shuffle(order.begin(), order.end(), std::mt19937(7));
    // Shuffled, and in pieces of every length from 1 to 23.
    Picture pieces(positions.size());
    std::vector<std::uint32_t> pieces_met(positions.size());
    std::size_t length = 1;
    for (std::size_t begin = 0; begin < order.size(); length = length % 23 + 1) {
      const std::size_t count = std::min(length, order.size() - begin);
      std::vector<PixelPosition> some;
      for (std::size_t i = 0; i < count; ++i) some.push_back(positions[order[begin + i]]);
      Picture samples(count);
      std::vector<std::uint32_t> met(count, 7);
      source->cast(some, samples, met);
      for (std::size_t i = 0; i < count; ++i) {
        pieces[order[begin + i]] = samples[i];
        pieces_met[order[begin + i]] = met[i];
      }
      begin += count;
    }
    EXPECT_TRUE(same_bits(whole, pieces)) << name;
    EXPECT_EQ(whole_met, pieces_met) << name;
  }
}

TEST_P(OnEveryInstructionSet, SurvivesBadVoxels) {
  std::mt19937 random(3);
  const auto volume =
      make_volume({.size = {19, 17, 15}}, VoxelType::kFloat32, [&](int i, int j, int k) {
        const auto dice = random() % 29;
        if (dice == 0) return kNan;
        if (dice == 1) return double(std::numeric_limits<float>::infinity());
        if (dice == 2) return 1e-42;
        return 4.0 * (i + j + k);
      });
  for (auto& [name, scene] : scenes_of_all_kernels(volume->info())) {
    scene.step_mm = 0.05;
    const auto positions = pixel_centres(scene.image.size);
    const Picture picture = cast(scene, volume, positions);
    EXPECT_TRUE(is_sane(picture)) << name;
    // Shading takes gradients across the border of a bad cell, where the two may differ.
    if (scene.volumes[0].shading) continue;
    const Distance found = distance(picture, reference_picture(scene, *volume, positions));
    EXPECT_LT(found.rms, name == "dvr" ? 0.5 : 8) << name;
  }
}

TEST(RayCaster, CopiesOfTheSameDataInOtherTypesGiveTheSamePicture) {
  const auto volume = blob_volume(VoxelType::kUInt8);
  for (const auto& [name, scene] : scenes_of_all_kernels(volume->info())) {
    const auto positions = pixel_centres(scene.image.size);
    const Picture picture = cast(scene, volume, positions);
    for (const VoxelType type :
         {VoxelType::kInt8, VoxelType::kUInt16, VoxelType::kInt16, VoxelType::kFloat32}) {
      const auto copy = make_volume(volume->info().geometry, type, [&](int i, int j, int k) {
        return std::min(volume->at(i, j, k), 127.0);
      });
      // int16 is interpolated as 32768 + value, where a float is good to 1/256 of a value and a
      // surface's place and normal feel it; the others keep 1/30000.
      const double rounding = type == VoxelType::kInt16 ? 0.5 : 0.1;
      EXPECT_LT(distance(picture, cast(scene, copy, positions)).greatest, rounding)
          << name << ' ' << name_of(type);
    }
  }
}

TEST(RayCaster, RaysAlongAnAxisThroughFacesEdgesAndCornersAreLikeTheirNeighbours) {
  VolumeGeometry geometry{.size = {17, 17, 17}};
  const auto volume = make_volume(geometry, VoxelType::kUInt8, [](int, int, int) { return 100; });
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0})
      for (const double u : {0.0, 8.0, 8.5, 16.0})
        for (const double v : {0.0, 8.0, 7.25, 16.0}) {
          glm::dvec3 place;
          place[axis] = sign > 0 ? -20 : 36;
          place[(axis + 1) % 3] = u;
          place[(axis + 2) % 3] = v;
          glm::dvec3 target = place;
          target[axis] = 8;
          Scene scene = ramp_scene(volume->info());
          scene.camera =
              Camera{place, target, axis == 2 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1), 30};
          scene.volumes[0].transfer_function->opacity = {{0, 0.1}};
          const Sample found = cast(scene, volume, {{16, 16}}).front();
          EXPECT_NEAR(found.alpha, 1 - std::pow(0.9, 16), 1e-5) << axis << ' ' << u << ' ' << v;
        }
}

TEST(RayCaster, TheCameraMayBeInsideTheVolumeOnItsFaceAndOnAVoxel) {
  VolumeGeometry geometry{.size = {17, 17, 17}};
  const auto volume = make_volume(geometry, VoxelType::kUInt8, [](int, int, int) { return 100; });
  for (const double z : {0.0, 0.3, 8.0, 15.99}) {
    Scene scene = ramp_scene(volume->info());
    scene.camera = Camera{{8, 8, z}, {8, 8, 17}, {0, 1, 0}, 30};
    scene.volumes[0].transfer_function->opacity = {{0, 0.1}};
    EXPECT_NEAR(cast(scene, volume, {{16, 16}}).front().alpha, 1 - std::pow(0.9, 16 - z), 1e-5)
        << z;
  }
}

TEST(RayCaster, AVolumeWithoutExtentGivesTheBackground) {
  for (const glm::ivec3 size : {glm::ivec3(1, 1, 1), glm::ivec3(9, 9, 1), glm::ivec3(1, 9, 9),
                                glm::ivec3(9, 1, 9), glm::ivec3(2, 1, 1)}) {
    const auto volume =
        make_volume({.size = size}, VoxelType::kUInt8, [](int i, int, int) { return 100 + i; });
    for (const auto& [name, scene] : scenes_of_all_kernels(volume->info())) {
      const Picture picture = cast(scene, volume, pixel_centres(scene.image.size));
      for (const Sample& sample : picture) EXPECT_EQ(sample, Sample{}) << name;
    }
  }
}

TEST(RayCaster, ASceneMovedFarAwayGivesTheSameImage) {
  const auto here = blob_volume();
  VolumeGeometry moved = here->info().geometry;
  const glm::dvec3 far(1e7, -1e7, 1e7);
  moved.origin_mm += far;
  const auto there =
      make_volume(moved, VoxelType::kUInt8, [&](int i, int j, int k) { return here->at(i, j, k); });
  for (auto& [name, scene] : scenes_of_all_kernels(here->info())) {
    const auto positions = pixel_centres(scene.image.size);
    const Picture picture = cast(scene, here, positions);
    Scene shifted = scene;
    shifted.camera->position += far;
    shifted.camera->target += far;
    for (Light& light : shifted.lights)
      if (auto* point = std::get_if<PointLight>(&light.kind)) point->position_mm += far;
    EXPECT_LT(distance(picture, cast(shifted, there, positions)).greatest, 0.05) << name;
  }
}

TEST(RayCaster, ACameraFarAwaySeesWhatTheReferenceSees) {
  const auto volume = blob_volume();
  Scene scene = ramp_scene(volume->info());
  const glm::dvec3 away = scene.camera->position - scene.camera->target;
  scene.camera->position = scene.camera->target + away * (1e6 / glm::length(away));
  scene.camera->fovy_deg = 0.003;
  scene.step_mm = 0.1;
  const auto positions = pixel_centres(scene.image.size);
  EXPECT_LT(
      distance(cast(scene, volume, positions), reference_picture(scene, *volume, positions)).rms,
      0.05);
}

TEST(RayCaster, RotatedMirroredAndShearedGridsLieWhereTheirMatrixSays) {
  const double c = std::cos(0.6), s = std::sin(0.6);
  const glm::dmat3 matrices[] = {glm::dmat3(c, s, 0, -s, c, 0, 0, 0, 1),
                                 glm::dmat3(-1, 0, 0, 0, -1, 0, 0, 0, 1),
                                 glm::dmat3(1, 0, 0, 0.3, 0.95, 0, 0.1, -0.2, 0.97)};
  for (const glm::dmat3& direction : matrices) {
    const VolumeGeometry geometry{.size = {21, 25, 12},
                                  .spacing_mm = {0.7, 1, 4},
                                  .origin_mm = {-30, 12, 55},
                                  .direction = direction};
    const auto volume = make_volume(geometry, VoxelType::kUInt8, [](int i, int j, int k) {
      return 60 + 50 * std::sin(0.4 * i) * std::cos(0.3 * j + 0.5 * k);
    });
    for (auto& [name, scene] : scenes_of_all_kernels(volume->info())) {
      scene.step_mm = 0.1;
      const auto positions = pixel_centres(scene.image.size);
      const Distance found = distance(cast(scene, volume, positions),
                                      reference_picture(scene, *volume, positions, 24));
      EXPECT_LT(found.rms, 0.3) << name;
    }
  }
}

TEST(RayCaster, OpacityZeroShowsNothingAndOpacityOneHides) {
  const auto volume = blob_volume();
  Scene scene = ramp_scene(volume->info());
  const auto positions = pixel_centres(scene.image.size);
  scene.volumes[0].transfer_function->opacity = {{0, 0}};
  for (const Sample& sample : cast(scene, volume, positions)) EXPECT_EQ(sample, Sample{});
  scene.volumes[0].transfer_function->opacity = {{0, 1}};
  scene.volumes[0].transfer_function->color = {{0, {0.25, 0.5, 1}}};
  const Sample centre = cast(scene, volume, {{16, 16}}).front();
  EXPECT_NEAR(centre.alpha, 1, 1.0 / 4096);
  EXPECT_NEAR(centre.green, 0.5, 1.0 / 4096);
}

TEST(RayCaster, ShadingWithoutLightIsTheAmbientTermAndNeedsNoGradient) {
  const auto volume = blob_volume();
  Scene scene = ramp_scene(volume->info());
  scene.volumes[0].shading = Shading{.ambient = 0.5};
  scene.lights.clear();
  const auto committed = commit_scene(scene, volume);
  EXPECT_EQ(feature_names(*committed), std::vector<std::string>{"dvr"});
  const auto positions = pixel_centres(scene.image.size);
  EXPECT_LT(
      distance(cast(scene, volume, positions), reference_picture(scene, *volume, positions)).rms,
      0.3);
}

TEST(RayCaster, AStepInTheTransferFunctionIsHonoured) {
  const auto volume = blob_volume();
  Scene scene = ramp_scene(volume->info());
  scene.volumes[0].transfer_function->opacity = {{0, 0}, {50, 0}, {50, 0.3}, {80, 0.3}, {80, 0}};
  scene.volumes[0].transfer_function->color = {
      {0, {1, 0, 0}}, {60, {1, 0, 0}}, {60, {0, 0, 1}}, {255, {0, 0, 1}}};
  scene.step_mm = 0.02;
  const auto positions = pixel_centres(scene.image.size);
  EXPECT_LT(
      distance(cast(scene, volume, positions), reference_picture(scene, *volume, positions, 64))
          .rms,
      0.5);
}

TEST(RayCaster, LinearColourSpaceTurnsInputsToLinearLight) {
  const auto volume = blob_volume();
  Scene scene = ramp_scene(volume->info());
  scene.image.color_space = ColorSpace::kLinear;
  scene.step_mm = 0.1;
  const auto positions = pixel_centres(scene.image.size);
  EXPECT_LT(
      distance(cast(scene, volume, positions), reference_picture(scene, *volume, positions)).rms,
      0.05);
}

TEST(RayCaster, RandomSmallScenesAreTheReferences) {
  std::mt19937 random(11);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int trial = 0; trial < 40; ++trial) {
    VolumeGeometry geometry;
    geometry.size = {2 + int(random() % 40), 2 + int(random() % 30), 2 + int(random() % 20)};
    geometry.spacing_mm = {uniform(0.5, 2), uniform(0.5, 2), uniform(0.5, 2)};
    const double a = uniform(0.1, 0.5), b = uniform(0.1, 0.5), c = uniform(0.1, 0.5);
    const auto type = VoxelType(random() % 5);
    const auto volume = make_volume(geometry, type, [&](int i, int j, int k) {
      return 60 + 50 * std::sin(a * i + 1) * std::cos(b * j) * std::sin(c * k + 2);
    });
    auto scenes = scenes_of_all_kernels(volume->info());
    auto& [name, scene] = scenes[std::size_t(trial) % scenes.size()];
    const double low = uniform(10, 60);
    scene.volumes[0].transfer_function->opacity = {
        {low, 0}, {low + uniform(1, 20), uniform(0, 1)}, {low + 40, uniform(0, 0.5)}};
    scene.camera = framing_camera(geometry, uniform(0, 360), uniform(-80, 80));
    if (trial % 3 == 0)
      scene.camera->position = 0.5 * (scene.camera->position + scene.camera->target);
    scene.step_mm = 0.05;
    const auto positions = pixel_centres(scene.image.size, 2);
    const Picture picture = cast(scene, volume, positions);
    EXPECT_TRUE(is_sane(picture));
    const Distance found = distance(picture, reference_picture(scene, *volume, positions, 32));
    EXPECT_LT(found.rms, 1.0) << trial << ' ' << name << ' ' << name_of(type);
  }
}

}  // namespace
}  // namespace goldthread::test
