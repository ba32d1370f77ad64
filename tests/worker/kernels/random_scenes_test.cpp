// SPDX-License-Identifier: Apache-2.0
// Thousands of random small scenes on every instruction set: the kernel against the reference
// integrator, each ray within a bound that follows from its step. A case that fails is written as
// files that can be rendered.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/scene/scene_file.h"
#include "common/volume/build_volume.h"
#include "common/volume/volume_io.h"
#include "error_bound.h"
#include "random_scene.h"
#include "scene_dump.h"
#include "worker/kernels/kernel_table.h"

namespace goldthread::test {
namespace {

constexpr unsigned kCases = 6000;
constexpr int kSubsteps = 24;

enum class Kind { kAbsorption, kSurfaces, kGreatest };
Kind kind_of(const Scene& scene) {
  const SceneVolume& volume = scene.volumes.front();
  if (volume.mode == Mode::kMip) return Kind::kGreatest;
  return volume.isosurfaces.empty() ? Kind::kAbsorption : Kind::kSurfaces;
}

std::filesystem::path scratch(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) /
         ("goldthread-" + name + "-" + std::to_string(getpid()));
}

constexpr double kRounding = 0.005 / 255;

// The suprema of the bound are taken over finitely many points.
constexpr double kSafety = 2;

// All rays of all cases of one kind.
struct Outcome {
  long cases = 0, rays = 0, beyond = 0;
  long tight = 0;  ///< rays whose bound is below 1/255
  double squares = 0;
  double greatest_share = 0;  ///< of the bound
  int dumped = 0;

  void print() const {
    std::printf(
        "  %ld cases, %ld rays: rms %.3f/255, at most %.2f of the bound; bound below 1/255 "
        "for %.0f %%; beyond %ld\n",
        cases, rays, 255 * std::sqrt(squares / (4.0 * double(rays))), greatest_share,
        100.0 * double(tight) / double(rays), beyond);
  }
};

void report(unsigned number, const std::string& set, const RandomCase& random, Outcome& outcome) {
  if (++outcome.dumped > 3) return;
  const auto folder = scratch("random-" + std::to_string(number));
  dump_scene(random.scene, *random.volume, folder);
  std::printf("  case %u on %s: %s\n", number, set.c_str(),
              render_command(random.scene, folder).c_str());
}

// How many times its bound a ray is off.
double share_of(const Sample& found, const Sample& expected, const RayBound& bound,
                double tolerance, Outcome& outcome) {
  const double off[4] = {found.red - expected.red, found.green - expected.green,
                         found.blue - expected.blue, found.alpha - expected.alpha};
  const double allowed[4] = {bound.color.r, bound.color.g, bound.color.b, bound.alpha};
  double share = 0;
  for (int c = 0; c < 4; ++c) {
    outcome.squares += off[c] * off[c];
    share = std::max(share, std::abs(off[c]) / (allowed[c] + tolerance));
  }
  return share;
}

// `tolerance` is added to the bounds.
Outcome compare(Kind kind, double tolerance) {
  Outcome outcome;
  const std::vector<std::string> sets = instruction_sets();
  for (unsigned number = 0; number < kCases; ++number) {
    const RandomCase random = random_case(number);
    if (kind_of(random.scene) != kind) continue;
    ++outcome.cases;
    const ErrorBound error_bound(random.scene, *random.volume, kSubsteps);
    const Picture expected =
        reference_picture(random.scene, *random.volume, random.rays, kSubsteps);
    std::vector<RayBound> bounds;
    for (const PixelPosition& ray : random.rays) bounds.push_back(error_bound.of(ray));
    for (const std::string& set : sets) {
      force_instruction_set(set);
      const Picture found = cast(random.scene, random.volume, random.rays);
      bool fails = false;
      for (std::size_t i = 0; i < found.size(); ++i) {
        const double share = share_of(found[i], expected[i], bounds[i], tolerance, outcome);
        const RayBound& b = bounds[i];
        ++outcome.rays;
        outcome.tight += std::max({b.alpha, b.color.r, b.color.g, b.color.b}) < 1.0 / 255;
        outcome.greatest_share = std::max(outcome.greatest_share, share);
        outcome.beyond += share > kSafety;
        fails = fails || share > kSafety;
      }
      if (fails && kind != Kind::kSurfaces) report(number, set, random, outcome);
    }
  }
  force_instruction_set("");
  outcome.print();
  return outcome;
}

TEST(RandomScenes, OfEmissionAndAbsorptionAreWithinTheBoundOfTheirStep) {
  const Outcome outcome = compare(Kind::kAbsorption, kRounding);
  EXPECT_EQ(outcome.beyond, 0);
  EXPECT_GT(outcome.tight, outcome.rays / 2);
  EXPECT_GT(outcome.cases, 3000);
}

TEST(RandomScenes, OfTheGreatestValueAreWithinTheBoundOfTheirStep) {
  const Outcome outcome = compare(Kind::kGreatest, kRounding);
  EXPECT_EQ(outcome.beyond, 0);
  EXPECT_GT(outcome.tight, outcome.rays / 2);
  EXPECT_GT(outcome.cases, 1000);
}

TEST(RandomScenes, OfSurfacesDifferInFewRays) {
  // Where a ray grazes a surface, rounding decides whether it is hit.
  const Outcome outcome = compare(Kind::kSurfaces, 0.5 / 255);
  EXPECT_LT(double(outcome.beyond), 1e-4 * double(outcome.rays));
  EXPECT_GT(outcome.cases, 1000);
}

// The least and greatest numbers that a scene file may hold, a few at a time.
void make_extreme(unsigned choice, Scene& scene) {
  SceneVolume& volume = scene.volumes.front();
  TransferFunction& function = *volume.transfer_function;
  const auto bit = [&](int i) { return (choice >> i & 1) != 0; };
  if (bit(0)) function.unit_distance_mm = bit(1) ? 1e-9 : 1e9;
  if (bit(2)) volume.shading = Shading{1000, 1000, 1000, bit(3) ? 1e6 : 1e-9};
  if (bit(4))
    for (Light& light : scene.lights) light.intensity = 1000;
  if (bit(5)) scene.step_mm = bit(6) ? 0.01 * scene.step_mm : 1e9;
  if (bit(7) && !volume.isosurfaces.empty()) volume.isosurfaces[0].value = bit(8) ? 3.4e38 : -0.0;
  if (bit(9)) function.opacity = {{-3.4e38, 1}, {0, 1e-300}, {3.4e38, 1}};
  if (bit(10)) scene.camera->fovy_deg = bit(11) ? 179.999 : 1e-6;
  if (bit(12)) function.color = {{-3.4e38, {0, 1, 0}}, {3.4e38, {1, 0, 1}}};
}

TEST(RandomScenes, WithExtremeNumbersGiveSaneSamples) {
  // cast() looks at each sample.
  const std::vector<std::string> sets = instruction_sets();
  for (unsigned number = 0; number < 2000; ++number) {
    RandomCase random = random_case(number);
    make_extreme(number * 2654435761U >> 7, random.scene);
    random.rays.push_back({-1e6F, 3e7F});
    for (const std::string& set : sets) {
      force_instruction_set(set);
      cast(random.scene, random.volume, random.rays);
      ASSERT_FALSE(testing::Test::HasFailure()) << "case " << number << " on " << set;
    }
  }
  force_instruction_set("");
}

TEST(RandomScenes, AreWrittenAsFilesThatGiveTheSamePicture) {
  const auto folder = scratch("dump");
  for (unsigned number = 0; number < 60; ++number) {
    const RandomCase random = random_case(number);
    dump_scene(random.scene, *random.volume, folder);
    Scene scene = value_or_throw(read_scene(folder / "scene.json"));
    scene.step_mm = random.scene.step_mm;
    const LoadedVolume loaded = value_or_throw(load_volume(scene.volumes[0].file));
    const auto volume = build_volume(loaded.info, loaded.voxels());
    EXPECT_EQ(volume->info().type, random.volume->info().type) << number;
    const Distance off =
        distance(cast(random.scene, random.volume, random.rays), cast(scene, volume, random.rays));
    EXPECT_LT(off.rms, 0.01) << number;
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace goldthread::test
