// SPDX-License-Identifier: Apache-2.0
// The default scene against the reference: the numbers that the default step is chosen by.

#include <gtest/gtest.h>

#include <cstdio>

#include "cast_support.h"
#include "common/scene/camera.h"

namespace goldthread::test {
namespace {

class Head : public testing::Test {
 protected:
  void SetUp() override {
    if (!volume()) GTEST_SKIP() << "Debian's mricron-data is not installed";
  }
  static const std::shared_ptr<const Volume>& volume() {
    static const std::shared_ptr<const Volume> head = load_head();
    return head;
  }
  static Distance error_of(const Scene& scene, int stride = 8) {
    const auto positions = pixel_centres(scene.image.size, stride);
    const Picture picture = cast(scene, volume(), positions);
    EXPECT_TRUE(is_sane(picture));
    const Distance found = distance(picture, reference_picture(scene, *volume(), positions, 24));
    std::printf("  rms %.4f, greatest %.3f, above 32: %.5f (in 1/255)\n", found.rms, found.greatest,
                found.share_above_32);
    return found;
  }
};

TEST_F(Head, UnlitIsWithinATenthOfA255thOfTheReferenceAtTheDefaultStep) {
  const Distance found = error_of(head_scene(volume()->info()));
  EXPECT_LT(found.rms, 0.1);
  EXPECT_LT(found.greatest, 1);
}

TEST_F(Head, HalvingTheStepQuartersTheError) {
  Scene scene = head_scene(volume()->info());
  scene.step_mm = 1.0;
  const Distance coarse = error_of(scene, 16);
  scene.step_mm = 0.5;
  const Distance fine = error_of(scene, 16);
  // Below, what early termination leaves out shows: 0.02/255.
  EXPECT_LT(fine.rms, coarse.rms / 3.5);
}

TEST_F(Head, ShadedIsWithinAQuarterOfA255thOfTheReferenceAtTheDefaultStep) {
  Scene scene = head_scene(volume()->info());
  scene.volumes[0].shading = Shading{};
  EXPECT_LT(error_of(scene).rms, 0.25);
}

TEST_F(Head, MipIsWithinATenthOfThe255thOfTheReference) {
  Scene scene = head_scene(volume()->info());
  scene.volumes[0].mode = Mode::kMip;
  EXPECT_LT(error_of(scene).rms, 0.1);
}

TEST_F(Head, AnOpaqueIsosurfaceIsTheReferences) {
  Scene scene = head_scene(volume()->info());
  scene.volumes[0].mode = Mode::kIsosurface;
  scene.volumes[0].shading = Shading{};
  scene.volumes[0].isosurfaces = {{80, {0.9, 0.8, 0.7}, 1}};
  const Distance found = error_of(scene);
  EXPECT_LT(found.rms, 0.001);
  EXPECT_EQ(found.share_above_32, 0);
}

}  // namespace
}  // namespace goldthread::test
