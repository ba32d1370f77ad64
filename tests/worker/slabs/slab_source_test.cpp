// SPDX-License-Identifier: Apache-2.0
// A volume in slabs gives the samples of the whole one, to the bit: random scenes of every mode and
// type, rays of every direction, and the head.

#include "worker/slabs/slab_source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>
#include <tuple>

#include "common/scene/resolve.h"
#include "random_scene.h"
#include "slab_support.h"
#include "worker/kernels/kernel_table.h"

namespace goldthread::test {
namespace {

constexpr unsigned kCases = 1500;

struct Met {
  Picture samples;
  std::vector<std::uint32_t> surfaces;
};

Met look(const SampleSource& source, const std::vector<PixelPosition>& rays) {
  Met met{Picture(rays.size()), std::vector<std::uint32_t>(rays.size())};
  source.cast(rays, met.samples, met.surfaces);
  return met;
}

/// How many rays differ in any bit of what they bring back.
std::size_t differing(const Met& a, const Met& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.samples.size(); ++i)
    count += std::memcmp(&a.samples[i], &b.samples[i], sizeof(Sample)) != 0 ||
                     a.surfaces[i] != b.surfaces[i]
                 ? 1
                 : 0;
  return count;
}

TEST(SlabSource, RandomScenesAreEqualToTheBitOnEveryInstructionSet) {
  for (const std::string& set : instruction_sets()) {
    force_instruction_set(set);
    long cases = 0, rays = 0, seen = 0;
    for (unsigned number = 0; number < kCases; ++number) {
      const RandomCase random = random_case(number);
      const int layers = layers_of(random.volume->info().geometry.size.z);
      const auto whole = commit_scene(random.scene, random.volume);
      if (layers < 2 || step_mm(*whole) > longest_slab_step_mm(random.volume->info().geometry))
        continue;
      const auto expected =
          look(*make_ray_caster(whole, *random.scene.camera, random.scene.image.size), random.rays);
      for (int slabs = 2; slabs <= layers; ++slabs) {
        const auto found =
            look(*slab_source_of(random.scene, cut(*random.volume, slabs)), random.rays);
        EXPECT_EQ(differing(expected, found), 0U)
            << set << ", case " << number << ", " << slabs << " slabs";
      }
      ++cases;
      rays += long(random.rays.size());
      seen += std::count_if(expected.samples.begin(), expected.samples.end(),
                            [](const Sample& s) { return s.alpha > 0; });
    }
    std::printf("  %s: %ld cases, %ld rays, %ld of which met something\n", set.c_str(), cases, rays,
                seen);
    EXPECT_GT(cases, 100);
    EXPECT_GT(seen, rays / 10);
  }
  force_instruction_set("");
}

/// Ripples in an oblique grid of 5 layers of cells.
std::shared_ptr<const Volume> oblique_bumps() {
  VolumeGeometry geometry{.size = {24, 20, 37}, .origin_mm = {-12, -9, -16}};
  geometry.direction =
      glm::dmat3(glm::dvec3(1, 0.1, 0), glm::dvec3(-0.1, 1, 0.2), glm::dvec3(0, -0.2, 0.9));
  return make_volume(geometry, VoxelType::kUInt8, [](int x, int y, int z) {
    const double distance = std::hypot(x - 11, y - 9.5, (z - 18) / 2.0);
    return std::clamp(255 - 22 * distance + 40 * std::sin(1.3 * x) * std::cos(y + z), 0.0, 255.0);
  });
}

Scene scene_of_bumps(const VolumeInfo& info, Mode mode, bool with_surfaces, bool lit) {
  Scene scene = ramp_scene(info);
  SceneVolume& volume = scene.volumes.front();
  volume.mode = mode;
  if (with_surfaces) volume.isosurfaces = {{90, {0.9, 0.7, 0.5}, 0.5}, {180, {0.4, 0.6, 0.9}, 1}};
  if (lit) volume.shading = Shading{};
  scene.image.size = {157, 123};
  return scene;
}

TEST(SlabSource, AFineLookAlongAcrossAndFromInsideIsEqualToTheBit) {
  const auto volume = oblique_bumps();
  std::mt19937 random(3);
  std::uniform_real_distribution<float> share(0, 1);
  std::vector<PixelPosition> rays(40000);
  for (PixelPosition& ray : rays) ray = {157 * share(random), 123 * share(random)};
  const glm::dvec3 places[] = {{3, 5, 90}, {45, -65, 20}, {2, -4, 1}};
  for (const auto& [mode, with_surfaces, lit] :
       {std::tuple{Mode::kDvr, false, true}, std::tuple{Mode::kDvr, true, true},
        std::tuple{Mode::kIsosurface, true, false}, std::tuple{Mode::kMip, false, false}}) {
    Scene scene = scene_of_bumps(volume->info(), mode, with_surfaces, lit);
    for (const glm::dvec3& place : places) {
      scene.camera =
          Camera{.position = place, .target = {0, 0, 0}, .up = {0, 1, 0}, .fovy_deg = 30};
      const auto expected = look(
          *make_ray_caster(commit_scene(scene, volume), *scene.camera, scene.image.size), rays);
      for (const int slabs : {2, 5}) {
        const auto found = look(*slab_source_of(scene, cut(*volume, slabs)), rays);
        EXPECT_EQ(differing(expected, found), 0U)
            << int(mode) << " from " << place.z << ", " << slabs << " slabs";
      }
    }
  }
}

TEST(SlabSource, OfEqualGreatestValuesTheFirstIsTakenInSlabsToo) {
  // Plateaus in each slab, and lone brighter voxels beside them.
  const auto volume =
      make_volume({.size = {20, 20, 40}}, VoxelType::kUInt8, [](int x, int y, int z) {
        if ((x * 7 + y * 13 + z * 5) % 31 == 0) return 103.0;
        return z % 8 < 3 || z > 36 ? 100.0 : 20.0;
      });
  Scene scene = scene_of_bumps(volume->info(), Mode::kMip, false, false);
  scene.camera = Camera{.position = {9, 11, -60}, .target = {10, 10, 20}, .up = {0, 1, 0}};
  std::mt19937 random(5);
  std::uniform_real_distribution<float> share(0, 1);
  std::vector<PixelPosition> rays(20000);
  for (PixelPosition& ray : rays) ray = {157 * share(random), 123 * share(random)};
  const auto expected =
      look(*make_ray_caster(commit_scene(scene, volume), *scene.camera, scene.image.size), rays);
  EXPECT_EQ(differing(expected, look(*slab_source_of(scene, cut(*volume, 5)), rays)), 0U);
}

/// Segments that all slabs cast at once, merged front to back: direct send, the way not taken.
struct Merged {
  Picture samples;
  std::uint64_t taken = 0;  ///< field evaluations
};

Merged merge_segments(const Scene& scene, const std::vector<std::shared_ptr<const Volume>>& slabs,
                      const std::vector<PixelPosition>& rays) {
  Merged merged{Picture(rays.size())};
  const SlabPaths paths(*scene.camera, scene.image.size, slabs.front()->info().geometry,
                        int(slabs.size()));
  std::vector<Picture> segments;
  for (const auto& slab : slabs) {
    Picture& segment = segments.emplace_back(rays.size());
    std::vector<std::uint32_t> met(rays.size());
    const auto caster =
        make_slab_caster(commit_scene(scene, slab), *scene.camera, scene.image.size);
    Stage stage = kGather;
    stage.closes = true;
    merged.taken += caster->advance({rays, segment, met}, stage).samples;
  }
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Sample& sum = merged.samples[i];
    for (std::size_t k = 0; k < slabs.size(); ++k) {
      const bool descends = paths.of(rays[i]).descends;
      const Sample& behind = segments[descends ? slabs.size() - 1 - k : k][i];
      const float open = 1 - sum.alpha;
      sum = {sum.red + open * behind.red, sum.green + open * behind.green,
             sum.blue + open * behind.blue, sum.alpha + open * behind.alpha};
    }
    sum = closed(sum);
  }
  return merged;
}

TEST(SlabSource, SegmentsThatAreCastAtOnceAndMergedMakeAnotherPictureAndMoreWork) {
  const auto volume = oblique_bumps();
  const Scene scene = [&] {
    Scene made = scene_of_bumps(volume->info(), Mode::kDvr, true, true);
    made.camera = Camera{.position = {3, 5, 90}, .target = {0, 0, 0}, .up = {0, 1, 0}};
    return made;
  }();
  const auto rays = pixel_centres(scene.image.size);
  const auto slabs = cut(*volume, 4);
  Picture samples(rays.size());
  std::vector<std::uint32_t> met(rays.size());
  const CastCounts counts = slab_source_of(scene, slabs)->cast(rays, samples, met);
  const Merged merged = merge_segments(scene, slabs, rays);
  const Distance apart = distance(samples, merged.samples);
  std::printf("  rms %.4f/255, at most %.3f/255; samples %.2f times as many\n", apart.rms,
              apart.greatest, double(merged.taken) / double(counts.samples));
  EXPECT_GT(apart.greatest, 0.05);
  EXPECT_GT(merged.taken, counts.samples * 11 / 10);
}

TEST(SlabSource, RaysThatSeeNoFurtherAreNotSentOn) {
  const auto volume =
      make_volume({.size = {16, 16, 32}}, VoxelType::kUInt8, [](int, int, int) { return 255.0; });
  Scene scene = ramp_scene(volume->info());
  scene.volumes.front().transfer_function->opacity = {{0, 0.9}, {255, 0.9}};
  scene.camera =
      Camera{.position = {7, 7, -90}, .target = {7, 7, 15}, .up = {0, 1, 0}, .fovy_deg = 5};
  const auto slabs = cut(*volume, 4);
  const auto link = slabs_at_hand(scene, slabs);
  const auto own = make_slab_caster(commit_scene(scene, slabs[3]), *scene.camera, scene.image.size);
  const auto source = make_slab_source(
      link, own, SlabPaths(*scene.camera, scene.image.size, volume->info().geometry, 4));
  const auto rays = pixel_centres(scene.image.size);
  look(*source, rays);
  EXPECT_GT(link->sent(0), 0U);
  EXPECT_EQ(link->sent(2) + link->sent(3), 0U);
}

}  // namespace
}  // namespace goldthread::test
