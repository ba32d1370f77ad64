// SPDX-License-Identifier: Apache-2.0
#include "bench/motion/methods.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "../error/small_subject.h"
#include "bench/motion/playback.h"
#include "common/scene/camera.h"

namespace goldthread::bench {
namespace {

class Methods : public testing::Test {
 protected:
  void SetUp() override {
    Subject subject = test::ball_subject("motion_methods");
    subject.scene.image.size = {96, 80};
    scene_ = motion_scene(subject, 1);
  }
  std::vector<Color> exact(const Camera& camera) const {
    return *shown_picture(full_frame(scene_, camera).pixels, scene_.image, 0).colors;
  }
  /// Of the last picture in 0.4 s of virtual time, since refinement never ends.
  double error_at_rest(MotionMethod& method, const Camera& camera, double& now) {
    double error = 255;
    for (const double end = now + 0.4; now < end;) {
      const WorkDone done = method.work(now, camera);
      now += std::max(done.seconds, 0.005);
      if (done.shown) error = rms_error(*done.shown->colors, exact(camera));
    }
    return error;
  }
  MotionScene scene_;
};

TEST_F(Methods, AreHeldAgainstTheMeanOfEachPixel) {
  const Camera camera = scene_.rest;
  const std::vector<Color> pixels = true_picture(scene_, camera);
  const auto source = make_ray_caster(scene_.committed, camera, scene_.image.size);
  for (const auto& [x, y] : {std::pair{0, 0}, {48, 40}, {30, 33}, {95, 79}, {17, 64}}) {
    std::vector<PixelPosition> positions;
    for (int i = 0; i < 9; ++i)
      positions.push_back(
          {float(x) + (float(i % 3) + 0.5F) / 3, float(y) + (float(i / 3) + 0.5F) / 3});
    std::vector<Sample> samples(positions.size());
    source->cast(positions, samples);
    const ShownPicture shown = shown_picture(samples, scene_.image, 0);
    Color sum(0);
    for (const Color& color : *shown.colors) sum += color;
    EXPECT_LT(glm::distance(pixels[std::size_t(96 * y + x)], sum / 9.0), 1e-6) << x << " " << y;
  }
}

TEST_F(Methods, ShowTheSceneItselfWhenTheCameraRests) {
  for (const auto& method : all_methods(scene_)) {
    double now = 0;
    EXPECT_GT(rms_error(exact(scene_.rest), std::vector<Color>(96 * 80)), 5)
        << "there is something";
    // Those with more than a sample in a pixel differ by their antialiasing.
    const bool same = method->name() == "full frames" || method->name().ends_with("of the pixels");
    for (const double degrees : {0.0, 30.0})
      EXPECT_LE(error_at_rest(*method, orbit(scene_.rest, degrees), now), same ? 0 : 1.5)
          << method->name();
  }
}

TEST_F(Methods, CostTimeAndSayWhenTheirNewestInputCame) {
  for (const auto& method : all_methods(scene_)) {
    int shown = 0;
    double now = 0, newest_seen = 0;
    for (int i = 0; i < 400; ++i) {
      const WorkDone done = method->work(now, orbit(scene_.rest, i));
      EXPECT_GT(done.seconds, 0);
      if (done.shown) {
        EXPECT_LE(done.shown->input_seconds, now);
        EXPECT_GE(done.shown->input_seconds, newest_seen) << method->name();
        newest_seen = done.shown->input_seconds;
        ++shown;
      }
      now += std::max(done.seconds, 0.001);
    }
    EXPECT_GT(shown, 10) << method->name() << " shows pictures of endless movement";
  }
}

TEST_F(Methods, HaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const auto& method : all_methods(scene_)) EXPECT_TRUE(names.insert(method->name()).second);
  EXPECT_EQ(names.size(), 6u);
}

TEST_F(Methods, AMachineThatIsSlowerOrHasMoreThreadsCostsAccordingly) {
  scene_.cost_factor = 6;
  scene_.threads = 3;
  EXPECT_DOUBLE_EQ(scene_.shared(1), 2);
  EXPECT_DOUBLE_EQ(scene_.alone(1), 6);
}

}  // namespace
}  // namespace goldthread::bench
