// SPDX-License-Identifier: Apache-2.0
// Which isosurfaces a ray met: one number per sequence, against crossings found in double.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>

#include "every_instruction_set.h"
#include "surface_probe.h"

namespace goldthread::test {
namespace {

class SurfacesMet : public EveryInstructionSet {};
GOLDTHREAD_ON_EVERY_INSTRUCTION_SET(SurfacesMet);

using Sequence = std::vector<int>;
using Numbers = std::vector<std::uint32_t>;

Scene scene_of(const Camera& camera, const std::vector<double>& isovalues, double opacity) {
  Scene scene = count_scene(camera, 0);
  scene.volumes[0].isosurfaces.clear();
  for (const double value : isovalues)
    scene.volumes[0].isosurfaces.push_back({value, {1, 1, 1}, opacity});
  return scene;
}

/// Also that asking for them changes no sample.
Numbers surfaces_met(const Scene& scene, const std::shared_ptr<const Volume>& volume,
                     const std::vector<PixelPosition>& rays) {
  const auto source = make_ray_caster(commit_scene(scene, volume), *scene.camera, scene.image.size);
  EXPECT_TRUE(source->has_surfaces());
  Picture picture(rays.size());
  Numbers numbers(rays.size(), 7);
  source->cast(rays, picture, numbers);
  EXPECT_TRUE(same_bits(picture, cast(*source, rays)));
  return numbers;
}

/// The surfaces in the order of the ray, or none where roundoff may decide.
std::optional<Sequence> sequence_of(const ExactField& field, const IndexRay& ray,
                                    const std::vector<double>& isovalues) {
  constexpr double kApart = 1e-4;  // mm
  std::vector<std::pair<double, int>> places;
  for (std::size_t i = 0; i < isovalues.size(); ++i) {
    const Crossings found = field.crossings(ray, isovalues[i]);
    if (found.clearance < 1e-4) return std::nullopt;
    for (const Crossing& hit : found.hits) places.emplace_back(hit.t_mm, int(i));
  }
  std::ranges::sort(places);
  Sequence sequence;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i > 0 && places[i].first - places[i - 1].first < kApart) return std::nullopt;
    sequence.push_back(places[i].second);
  }
  return sequence;
}

/// Keeps that each sequence has one number of its own.
class Dictionary {
 public:
  void add(const Sequence& sequence, std::uint32_t number) {
    const auto [known_number, is_new] = numbers_.try_emplace(sequence, number);
    EXPECT_EQ(known_number->second, number);
    if (is_new) {
      EXPECT_TRUE(sequences_.try_emplace(number, sequence).second);
    }
  }
  std::size_t size() const { return numbers_.size(); }

 private:
  std::map<Sequence, std::uint32_t> numbers_;
  std::map<std::uint32_t, Sequence> sequences_;
};

std::shared_ptr<const Volume> spheres() {
  return make_volume({.size = {33, 33, 33}}, VoxelType::kFloat32,
                     [](int i, int j, int k) { return glm::length(glm::dvec3(i, j, k) - 16.0); });
}

TEST_P(SurfacesMet, NestedSpheresAreToldApartByHowManyOfThemARayMeets) {
  const auto volume = spheres();
  const ExactField field(*volume);
  const std::vector<double> radii{4.2, 6.9, 9.3, 11.4, 14.1};
  // Seen from outside, and from the middle: then each is met once.
  for (const double z : {-60.0, 16.0}) {
    const Scene scene = scene_of({{16, 16, z}, {16, 16, 40}, {0, 1, 0}, 40}, radii, 0.05);
    const auto rays = pixel_centres(scene.image.size);
    const Numbers numbers = surfaces_met(scene, volume, rays);
    Dictionary dictionary;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const IndexRay ray = index_ray(scene, field.geometry(), rays[i]);
      const auto sequence = sequence_of(field, ray, radii);
      if (!sequence) continue;
      dictionary.add(*sequence, numbers[i]);
      EXPECT_EQ(numbers[i] == 0, sequence->empty());
    }
    EXPECT_EQ(dictionary.size(), z < 0 ? 6u : 1u);
  }
}

TEST_P(SurfacesMet, EverySequenceInRandomCellsHasANumberOfItsOwn) {
  Random random(9);
  const std::vector<double> isovalues{0.35, 0.5, 0.62, 0.8};
  Dictionary dictionary;
  for (int round = 0; round < 40; ++round) {
    const auto volume = random_volume(6, {VoxelType::kFloat32, 0, 1}, random);
    const ExactField field(*volume);
    const Scene scene = scene_of(random_camera(6, random), isovalues, 0.01);
    const auto rays = random_rays(256, random);
    const Numbers numbers = surfaces_met(scene, volume, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const IndexRay ray = index_ray(scene, field.geometry(), rays[i]);
      if (const auto sequence = sequence_of(field, ray, isovalues))
        dictionary.add(*sequence, numbers[i]);
    }
  }
  EXPECT_GT(dictionary.size(), 1000u);
}

TEST_P(SurfacesMet, TheOrderCountsAndTheDirectionOfACrossingDoesNot) {
  const auto slope =
      make_volume({.size = {9, 9, 33}}, VoxelType::kUInt8, [](int, int, int k) { return 5.0 * k; });
  const std::vector<double> two{42, 81};
  const auto met = [&](double z, const std::vector<double>& isovalues) {
    const Scene scene = scene_of({{4.1, 4.2, z}, {4.1, 4.2, 16}, {0, 1, 0}, 5}, isovalues, 0.5);
    return surfaces_met(scene, slope, {{32, 32}}).front();
  };
  EXPECT_NE(met(-9, two), met(50, two));
  EXPECT_EQ(met(-9, {42}), met(50, {42}));
  EXPECT_EQ(met(-9, {42}), met(-9, {81}));
}

TEST_P(SurfacesMet, WhatLiesBehindAnOpaqueOneIsNotMet) {
  const auto volume = spheres();
  Scene scene = scene_of({{16, 16, -60}, {16, 16, 16}, {0, 1, 0}, 20}, {5, 10}, 1);
  const auto rays = pixel_centres(scene.image.size);
  const Numbers numbers = surfaces_met(scene, volume, rays);
  scene.volumes[0].isosurfaces.erase(scene.volumes[0].isosurfaces.begin());
  const Numbers outer = surfaces_met(scene, volume, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(numbers[i] == 0, outer[i] == 0);
  EXPECT_EQ(std::ranges::max(numbers), 2u);
}

TEST(SurfacesNotMet, AreZeroWhereASceneHasNone) {
  const auto volume = spheres();
  Scene scene = ramp_scene(volume->info());
  for (const Mode mode : {Mode::kDvr, Mode::kMip}) {
    scene.volumes[0].mode = mode;
    const auto source =
        make_ray_caster(commit_scene(scene, volume), *scene.camera, scene.image.size);
    EXPECT_FALSE(source->has_surfaces());
    const auto rays = pixel_centres(scene.image.size);
    Picture picture(rays.size());
    Numbers numbers(rays.size(), 7);
    source->cast(rays, picture, numbers);
    EXPECT_EQ(numbers, Numbers(rays.size(), 0));
  }
}

}  // namespace
}  // namespace goldthread::test
