// SPDX-License-Identifier: Apache-2.0
#include "bench/error/subject.h"

#include <gtest/gtest.h>

#include <set>

#include "bench/error/frame.h"
#include "bench/error/rounds.h"
#include "small_subject.h"

namespace goldthread::bench {
namespace {

class BenchSubject : public testing::Test {
 protected:
  const Subject subject_ = test::ball_subject("bench_subject");

  std::vector<Color> picture(const Scene& scene, std::shared_ptr<const Volume> volume) {
    FrameCaster caster(scene.image.size, 1);
    OwnMethod method(scene, std::move(volume));
    method.frame_seconds(caster);
    return caster.shown(scene.image, 1);
  }
};

TEST_F(BenchSubject, LooksDifferInWhatTheyNameAlone) {
  const Scene unlit = subject_.in(Look::kUnlit), phong = subject_.in(Look::kPhong, 0.25);
  EXPECT_FALSE(unlit.volumes[0].shading);
  EXPECT_TRUE(phong.volumes[0].shading);
  EXPECT_EQ(phong.step_mm, 0.25);
  EXPECT_EQ(subject_.in(Look::kMip).volumes[0].mode, Mode::kMip);
  EXPECT_EQ(subject_.in(Look::kIsosurface).volumes[0].isosurfaces.size(), 1u);
  EXPECT_EQ(subject_.with_isovalue(99).volumes[0].isosurfaces[0].value, 99);
  EXPECT_EQ(unlit.camera, phong.camera);
}

TEST_F(BenchSubject, IntegersChangeTheirIsovalueByOne) {
  EXPECT_EQ(subject_.isovalue, 80);
  EXPECT_EQ(subject_.next_isovalue, 81);
}

TEST_F(BenchSubject, EveryKindOfVoxelShowsTheSamePicture) {
  const auto variants = stored_variants(subject_);
  ASSERT_EQ(variants.size(), 3u);
  const auto first = picture(variants[0].scene, variants[0].volume);
  EXPECT_LT(picture_error(first, picture(subject_.in(Look::kUnlit), subject_.volume)).rms, 1e-6);
  for (const Stored& stored : variants) {
    EXPECT_EQ(name_of(stored.volume->info().type), stored.name);
    EXPECT_LT(picture_error(picture(stored.scene, stored.volume), first).rms, 0.01) << stored.name;
  }
}

TEST_F(BenchSubject, WhatIsOffChangesNothingAndWhatIsOnDoes) {
  const auto cases = feature_cases(subject_);
  std::set<std::string> names;
  for (const FeatureCase& each : cases) {
    EXPECT_TRUE(names.insert(each.name).second) << each.name;
    if (each.base.empty()) continue;
    const auto base = std::find_if(cases.begin(), cases.end(), [&](const FeatureCase& other) {
      return other.name == each.base;
    });
    ASSERT_NE(base, cases.end()) << each.base;
    const double rms =
        picture_error(picture(each.scene, subject_.volume), picture(base->scene, subject_.volume))
            .rms;
    if (each.off)
      EXPECT_LT(rms, 0.01) << each.name;
    else
      EXPECT_GT(rms, 0.1) << each.name;
  }
}

TEST_F(BenchSubject, AVolumeWithoutDepthIsRefused) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "bench_flat";
  std::filesystem::create_directories(folder);
  const auto file = folder / "flat_4x4x1_uint8.raw";
  std::ofstream(file, std::ios::binary) << std::string(16, 'x');
  const auto refused = load_subject(value_or_throw(read_scene(file)), false);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.failure().what, "is only one voxel thick");
}

}  // namespace
}  // namespace goldthread::bench
