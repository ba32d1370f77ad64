// SPDX-License-Identifier: Apache-2.0
#include "bench/motion/playback.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "common/scene/camera.h"

namespace goldthread::bench {
namespace {

/// A camera whose place along x is its time, and a picture of one pixel that shows it.
const CameraPath kClock{"clock", "", [](double t) {
                          Camera camera;
                          camera.position.x = t;
                          camera.target.x = t;
                          return camera;
                        }};
std::vector<Color> picture_of(const Camera& camera) { return {Color(camera.position.x / 10)}; }

/// Takes so long for each frame, or only works once.
class Frames : public MotionMethod {
 public:
  Frames(double seconds, bool once) : seconds_(seconds), once_(once) {}
  std::string name() const override { return "frames"; }
  WorkDone work(double now, const Camera& newest) override {
    calls.push_back(now);
    if (once_ && calls.size() > 1) return {0.001, {}};
    return {seconds_,
            ShownPicture{std::make_shared<const std::vector<Color>>(picture_of(newest)), now}};
  }
  std::vector<double> calls;

 private:
  double seconds_;
  bool once_;
};

Showing show(double frame_seconds, bool once = false) {
  std::vector<std::unique_ptr<MotionMethod>> methods;
  methods.push_back(std::make_unique<Frames>(frame_seconds, once));
  return play(kClock, methods, picture_of, {.seconds = 2}).front();
}

TEST(Playback, AFrameIsSeenFromItsEndUntilTheNextOnesEnd) {
  // Frames of 50 ms, three looks each: 50, 67 and 83 ms after their camera, or a whole frame more
  // where roundoff lets a frame end just behind the look.
  const Showing showing = show(0.049);
  for (std::size_t i = 0; i < showing.seconds.size(); ++i) {
    const double frames = std::floor(showing.seconds[i] / 0.049);
    EXPECT_NEAR(showing.latency[i], showing.seconds[i] - 0.049 * (frames - 1), 1e-9);
    EXPECT_NEAR(showing.rms[i], 25.5 * showing.latency[i], 25.5e-3 + 1e-9)
        << "inputs are 1 ms apart";
  }
  EXPECT_NEAR(showing.mean_latency(), 0.049 * 1.5, 0.002);
  EXPECT_NEAR(showing.pictures_per_second, 1 / 0.049, 1);
}

TEST(Playback, NoMorePicturesAreSeenThanTheDisplayShows) {
  const Showing showing = show(0.002);
  EXPECT_DOUBLE_EQ(showing.pictures_per_second, kDisplaysPerSecond);
  EXPECT_LE(showing.mean_latency(), 0.004);
}

TEST(Playback, APictureThatIsNeverReplacedGrowsOld) {
  const Showing showing = show(0.01, true);
  EXPECT_NEAR(showing.latency.back(), 2, 1e-9);
  EXPECT_EQ(showing.pictures_per_second, 0) << "it came while warming up";
}

TEST(Playback, AScreenWithNothingIsAsFarOffAsCanBe) { EXPECT_EQ(show(100).mean_rms(), 255); }

TEST(Showing, ThePercentileIsOfTheNearestRank) {
  Showing showing;
  for (int i = 1; i <= 40; ++i) showing.rms.push_back(41 - i);
  EXPECT_EQ(showing.percentile95_rms(), 38);
  EXPECT_EQ(showing.mean_rms(), 20.5);
}

TEST(RmsError, IsOverAllChannelsOfAllPixels) {
  const std::vector<Color> one{{0, 0, 0}, {0.5, 0.5, 0.5}}, other{{0.3, 0, 0}, {0.5, 0.5, 0.1}};
  EXPECT_NEAR(rms_error(one, other), 255 * std::sqrt((0.09 + 0.16) / 6), 1e-12);
}

Camera example() { return {{10, -500, 60}, {3, 0, 20}, {0, 0, 1}, 30}; }

TEST(CameraPaths, BeginAtRestAndKeepTheirDistanceFromTheTarget) {
  const auto paths = camera_paths(example());
  ASSERT_EQ(paths.size(), 4u);
  for (const CameraPath& path : paths) {
    EXPECT_NEAR(glm::distance(path.at(0).position, example().position), 0, 1e-9) << path.name;
    for (double t = 0; t < kPathSeconds; t += 0.0371) {
      const Camera camera = path.at(t);
      EXPECT_FALSE(camera_fault(camera).any());
      EXPECT_EQ(camera.target, example().target);
      EXPECT_NEAR(glm::distance(camera.position, camera.target),
                  glm::distance(example().position, example().target), 1e-9);
    }
  }
}

/// Degrees about the target between two times.
double turned(const CameraPath& path, double from, double to) {
  const auto arm = [&](double t) {
    return glm::normalize(path.at(t).position - path.at(t).target);
  };
  return glm::degrees(std::acos(std::min(1.0, glm::dot(arm(from), arm(to)))));
}

TEST(CameraPaths, MoveAsTheyAreDescribed) {
  std::map<std::string, CameraPath> paths;
  Camera level = example();
  level.position.z = level.target.z;
  for (const CameraPath& path : camera_paths(level)) paths[path.name] = path;
  EXPECT_NEAR(turned(paths["slow orbit"], 1, 2), 20, 1e-6);
  EXPECT_NEAR(turned(paths["fast turn"], 1, 2), 90, 1e-6);
  EXPECT_NEAR(turned(paths["stop and go"], 1, 1.5), 30, 1e-6);
  EXPECT_EQ(paths["stop and go"].at(1.5), paths["stop and go"].at(1.99));
  double farthest = 0;
  for (double t = 0; t < kPathSeconds; t += 0.01)
    farthest = std::max(farthest, turned(paths["jitter"], 0, t));
  EXPECT_GT(farthest, 0.5);
  EXPECT_LT(farthest, 0.55 * std::sqrt(2.0) + 1e-6);
}

TEST(CameraPaths, InputsComeAtWholeMilliseconds) {
  const CameraPath path = camera_paths(example()).front();
  EXPECT_EQ(newest_input(path, 0.0129), newest_input(path, 0.012));
  EXPECT_EQ(newest_input(path, 0.012), path.at(0.012));
  EXPECT_FALSE(newest_input(path, 0.013) == newest_input(path, 0.012));
}

}  // namespace
}  // namespace goldthread::bench
