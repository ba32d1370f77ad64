// SPDX-License-Identifier: Apache-2.0
#include "bench/motion/motion_scene.h"

#include <algorithm>
#include <ctime>

#include "bench/error/frame.h"
#include "common/tile/tile_grid.h"

namespace goldthread::bench {
namespace {

constexpr std::size_t kPoints = 64;
constexpr std::size_t kBatch = 1024;
constexpr int kTrueRays = 3;  ///< of a pixel's row and column

}  // namespace

double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

double thread_seconds_of(const std::function<void()>& work) {
  const double start = thread_seconds();
  work();
  return thread_seconds() - start;
}

MotionScene motion_scene(const Subject& subject, int threads) {
  MotionScene scene;
  scene.committed = commit_scene(subject.scene, subject.volume);
  scene.image = subject.scene.image;
  scene.rest = *subject.scene.camera;
  scene.points = visible_points(*scene.committed, kPoints);
  scene.threads = threads;
  return scene;
}

CountedRays::CountedRays(const MotionScene& scene, const Camera& camera) {
  seconds_ = thread_seconds_of(
      [&] { source_ = make_ray_caster(scene.committed, camera, scene.image.size); });
}

void CountedRays::cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                       std::span<std::uint32_t> surfaces) {
  seconds_ += thread_seconds_of([&] {
    for (std::size_t first = 0; first < positions.size(); first += kBatch) {
      const std::size_t count = std::min(kBatch, positions.size() - first);
      source_->cast(positions.subspan(first, count), samples.subspan(first, count),
                    surfaces.empty() ? surfaces : surfaces.subspan(first, count));
    }
  });
}

ShownPicture shown_picture(std::span<const Sample> pixels, const ImageSettings& image,
                           double input_seconds) {
  auto colors = std::make_shared<std::vector<Color>>(pixels.size());
  std::transform(pixels.begin(), pixels.end(), colors->begin(), [&](const Sample& sample) {
    return displayed(sample, image.background, image.color_space == ColorSpace::kLinear);
  });
  return {std::move(colors), input_seconds};
}

FullFrame full_frame(const MotionScene& scene, const Camera& camera) {
  const ImageSize size = scene.image.size;
  const std::vector<SampleOffset> places = grid_places(size, 1);
  std::vector<PixelPosition> positions(places.size());
  std::transform(places.begin(), places.end(), positions.begin(),
                 [&](SampleOffset place) { return position_of(scene.rect(), place); });
  std::vector<Sample> samples(places.size());
  CountedRays rays(scene, camera);
  rays.cast(positions, samples);
  FullFrame frame{std::vector<Sample>(places.size()), rays.seconds()};
  for (std::size_t i = 0; i < places.size(); ++i)
    frame.pixels[std::size_t(places[i].y) * std::size_t(size.width) + places[i].x] = samples[i];
  return frame;
}

std::vector<Color> true_picture(const MotionScene& scene, const Camera& camera) {
  const ImageSize size = scene.image.size;
  const auto source = make_ray_caster(scene.committed, camera, size);
  const TileGrid grid = TileGrid::squares(size, 16);
  std::vector<Color> colors(std::size_t(size.width) * std::size_t(size.height));
  in_parallel(scene.threads, grid.count(), [&](std::size_t i) {
    const PixelRect tile = grid.rect({static_cast<std::uint32_t>(i)});
    std::vector<PixelPosition> positions;
    for (int y = 0; y < kTrueRays * tile.height; ++y)
      for (int x = 0; x < kTrueRays * tile.width; ++x)
        positions.push_back({float(tile.x) + (float(x) + 0.5F) / kTrueRays,
                             float(tile.y) + (float(y) + 0.5F) / kTrueRays});
    std::vector<Sample> samples(positions.size());
    source->cast(positions, samples);
    const ShownPicture shown = shown_picture(samples, scene.image, 0);
    for (int y = 0; y < kTrueRays * tile.height; ++y)
      for (int x = 0; x < kTrueRays * tile.width; ++x) {
        const auto pixel = std::size_t(tile.y + y / kTrueRays) * std::size_t(size.width) +
                           std::size_t(tile.x + x / kTrueRays);
        colors[pixel] +=
            (*shown.colors)[std::size_t(y) * std::size_t(kTrueRays * tile.width) + std::size_t(x)] /
            Color(kTrueRays * kTrueRays);
      }
  });
  return colors;
}

}  // namespace goldthread::bench
