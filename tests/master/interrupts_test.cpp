// SPDX-License-Identifier: Apache-2.0
// Views that begin at any time, in a cluster of threads: whatever is shown is of one view, and what
// a view converges to does not depend on the views that were given up before it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>

#include "loopback_cluster.h"
#include "master/render_job.h"

namespace goldthread::test {
namespace {

constexpr ImageSize kImage{96, 80};
const TileGrid kGrid = TileGrid::squares(kImage, 32);
constexpr int kViews = 10000;

/// The colour that all of a view has.
Sample color_of(const Camera& camera) {
  const auto fraction = [](double value) { return static_cast<float>(value - std::floor(value)); };
  const double x = camera.position.x;
  return {fraction(0.618 * x), fraction(0.414 * x), fraction(0.732 * x), 1};
}

class FlatSource final : public SampleSource {
 public:
  explicit FlatSource(const Camera& camera) : color_(color_of(camera)) {}
  CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                  std::span<std::uint32_t>) const override {
    std::fill(samples.begin(), samples.end(), color_);
    return {positions.size(), positions.size()};
  }

 private:
  Sample color_;
};

std::shared_ptr<const SampleSource> make_flat(const std::shared_ptr<const CommittedScene>&,
                                              const Camera& camera, ImageSize) {
  return std::make_shared<FlatSource>(camera);
}

/// A user who turns the camera at any time, and looks at what is shown.
class Restless {
 public:
  explicit Restless(LoopbackCluster& loopback)
      : cluster_(loopback.cluster()), scene_(loopback.scene()) {
    colors_.push_back({});  // there is no epoch 0
  }

  void begin_view() {
    current_bands_ = 0;
    scene_.camera->position.x = 1 + below(1 << 20);
    colors_.push_back(color_of(*scene_.camera));
    update_ = chance(0.5) ? Update::kWhole : Update::kAll;
    cluster_.begin_view(scene_, {kGrid, {}, update_});
    ASSERT_EQ(cluster_.view().epoch.value + 1, colors_.size());
  }

  /// Some polls, with and without waiting; the view goes on meanwhile.
  void poll_a_little() {
    for (int polls = below(6); polls > 0; --polls) poll(std::chrono::microseconds(below(300)));
  }

  /// Asks for the picture; its bands come with later polls.
  void collect() {
    const Topology& topology = cluster_.topology();
    for (int c = 0; c < topology.compositors; ++c)
      cluster_.post().to_compositor(topology.compositor(c), CollectBand{cluster_.view().epoch});
  }

  /// Waits until the view can be shown and every worker is at it.
  void wait_for_picture() {
    while (cluster_.view().held == kNoStep ||
           cluster_.view().workers_begun < cluster_.topology().workers)
      poll(std::chrono::milliseconds(20));
    taken_.push_back(cluster_.view().taken.count());
  }

  /// Waits for the bands of the view.
  void wait_for_bands() {
    while (current_bands_ < cluster_.topology().compositors) poll(std::chrono::milliseconds(20));
  }

  bool chance(double share) { return std::uniform_real_distribution()(random_) < share; }
  int bands() const { return bands_; }
  int stale_bands() const { return stale_bands_; }
  /// Seconds from a view's begin until the last worker had taken it up, ascending.
  std::vector<double> taken() const {
    auto sorted = taken_;
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  }

 private:
  int below(int end) { return std::uniform_int_distribution(0, end - 1)(random_); }

  void poll(std::chrono::microseconds at_most) {
    const auto event = cluster_.poll(at_most);
    if (!event) return;
    if (std::holds_alternative<StepCast>(*event) && update_ == Update::kAll)
      cluster_.refine_further();
    if (const auto* band = std::get_if<BandPicture>(&*event)) look_at(*band);
  }

  /// Every pixel must have the colour of the view that the band says it is of.
  void look_at(const BandPicture& band) {
    ++bands_;
    if (band.epoch == cluster_.view().epoch)
      ++current_bands_;
    else
      ++stale_bands_;
    const Sample color = colors_.at(band.epoch.value);
    std::vector<Sample> pixels(band.pixels.size() / sizeof(Sample));
    std::memcpy(pixels.data(), band.pixels.data(), pixels.size() * sizeof(Sample));
    ASSERT_EQ(pixels.size(), std::size_t(band.rect.width) * std::size_t(band.rect.height));
    const auto others = std::count_if(pixels.begin(), pixels.end(),
                                      [&](const Sample& pixel) { return pixel != color; });
    EXPECT_EQ(others, 0) << "pixels of another view in epoch " << band.epoch.value;
  }

  Cluster& cluster_;
  Scene scene_;
  std::mt19937 random_{1};
  Update update_ = Update::kAll;
  std::vector<Sample> colors_;  ///< by epoch
  std::vector<double> taken_;
  int bands_ = 0;
  int current_bands_ = 0;
  int stale_bands_ = 0;
};

TEST(Interrupts, NoRegionOfAStaleViewEverShows) {
  LoopbackCluster loopback({2, 2}, kImage, make_flat);
  Restless user(loopback);
  int looked = 0;
  for (int i = 0; i < kViews; ++i) {
    user.begin_view();
    user.poll_a_little();
    if (!user.chance(0.25)) continue;
    user.wait_for_picture();
    user.poll_a_little();  // on to later steps
    user.collect();
    ++looked;
    if (user.chance(0.5)) user.wait_for_bands();
  }
  EXPECT_GT(user.bands(), looked);
  const auto taken = user.taken();
  const auto at = [&](double share) {
    return 1e3 * taken[std::size_t(share * double(taken.size() - 1))];
  };
  std::printf("  %d views, %d pictures, %d bands of views just given up\n", kViews, looked,
              user.stale_bands());
  std::printf(
      "  until the last worker took a view up: median %.2f ms, 99%% %.2f ms, most %.2f ms\n",
      at(0.5), at(0.99), at(1));
}

TEST(Interrupts, NoStepOfAStaleViewIsTold) {
  LoopbackCluster loopback({1, 1}, kImage, make_flat);
  Cluster& cluster = loopback.cluster();
  const auto begin = [&] { cluster.begin_view(loopback.scene(), {kGrid, {}}); };
  for (int i = 0; i < 100; ++i) {
    begin();
    // One message may tell two events; the second lies in wait.
    while (cluster.view().held == kNoStep) cluster.poll(std::chrono::milliseconds(20));
    begin();
    const auto event = cluster.poll(std::chrono::microseconds(0));
    EXPECT_TRUE(!event || cluster.view().cast() > kNoStep) << "a step of a view without any";
  }
}

RenderedFrame render(LoopbackCluster& loopback) {
  RenderRequest request;
  request.cut.grid = kGrid;
  request.stop.error = 0.05;
  return render_frame(loopback.cluster(), loopback.scene(), request);
}

void expect_same(const RenderedFrame& a, const RenderedFrame& b) {
  ASSERT_EQ(a.rgba.size(), b.rgba.size());
  EXPECT_EQ(std::memcmp(a.rgba.data(), b.rgba.data(), a.rgba.size() * sizeof(float)), 0);
  EXPECT_EQ(a.view.rays, b.view.rays);
  EXPECT_EQ(a.view.held, b.view.held);
  EXPECT_EQ(a.view.shown()->quality.squared_error, b.view.shown()->quality.squared_error);
}

/// Begins views and gives them up at any time.
void turn_about(LoopbackCluster& loopback, std::mt19937& random) {
  Cluster& cluster = loopback.cluster();
  std::uniform_int_distribution few(0, 5), time_us(0, 2000);
  for (int views = few(random); views > 0; --views) {
    Scene scene = loopback.scene();
    scene.camera->position += glm::dvec3(few(random), few(random), few(random));
    cluster.begin_view(scene, {kGrid, {}});
    for (int polls = few(random); polls > 0; --polls) {
      const auto event = cluster.poll(std::chrono::microseconds(time_us(random)));
      if (event && std::holds_alternative<StepCast>(*event)) cluster.refine_further();
    }
  }
}

TEST(Interrupts, AConvergedPictureIsTheSameWhateverWasGivenUpBeforeIt) {
  LoopbackCluster loopback({2, 2}, kImage);
  std::mt19937 random(2);
  const RenderedFrame first = render(loopback);
  EXPECT_GT(first.view.held, kFirstAdaptiveStep);
  for (int round = 0; round < 40; ++round) {
    turn_about(loopback, random);
    expect_same(render(loopback), first);
  }
}

TEST(Interrupts, AConvergedPictureIsTheSameForAnyNumberOfRanks) {
  LoopbackCluster two({2, 2}, kImage), one({1, 1}, kImage), more({3, 4}, kImage);
  const RenderedFrame picture = render(two);
  expect_same(render(one), picture);
  expect_same(render(more), picture);
}

}  // namespace
}  // namespace goldthread::test
