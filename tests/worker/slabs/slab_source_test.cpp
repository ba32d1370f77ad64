// SPDX-License-Identifier: Apache-2.0
// A volume in slabs gives the samples of the whole one, to the bit: random scenes of every mode and
// type, rays of every direction, and the head.

#include "worker/slabs/slab_source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstring>

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
      if (layers < 2 || half_step_in_slices(*whole) > kMostOverhang) continue;
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

}  // namespace
}  // namespace goldthread::test
