// SPDX-License-Identifier: Apache-2.0
#include "bench/throughput/back_end.h"

#include <chrono>
#include <cstring>
#include <memory>
#include <utility>

#include "compositor/aged_band.h"
#include "compositor/canvas.h"
#include "compositor/encode.h"
#include "compositor/reconstruct.h"
#include "compositor/sample_array.h"
#include "worker/ray_caster.h"
#include "worker/refine_tile.h"

namespace goldthread::bench {
namespace {

constexpr int kTile = 64;

/// How a frame came about.
struct Frame {
  const char* name;
  Sampling sampling;
  Update update;
  Step last;
};
constexpr Frame kFrames[] = {
    {"each pixel", Sampling::kEveryPixel, Update::kAll, kFirstAdaptiveStep},
    {"adaptive", Sampling::kAdaptive, Update::kAll, {10}},
    {"a moving frame", Sampling::kEveryPixel, Update::kWhole, {1}}};

Seconds time_of(int repeats, const std::function<void()>& work) {
  work();  // memory is there from now on
  std::vector<double> seconds(static_cast<std::size_t>(repeats));
  for (double& each : seconds) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    each = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  return summarize(seconds);
}

BeginView view_of(const Subject& subject, ImageSize size, const Frame& frame) {
  BeginView view;
  view.epoch = {1};
  view.camera = *subject.scene.camera;
  view.grid = TileGrid::squares(size, kTile);
  view.refinement.sampling = frame.sampling;
  view.update = frame.update;
  view.background = subject.scene.image.background;
  view.color_space = subject.scene.image.color_space;
  return view;
}

/// All that workers would send.
std::vector<Samples> samples_of(const BeginView& view, Step last,
                                const std::shared_ptr<const CommittedScene>& scene) {
  const CastView cast{view.epoch,
                      view.grid,
                      view.refinement,
                      appearance_of(view.background, view.color_space),
                      make_ray_caster(scene, view.camera, view.grid.image),
                      view.update,
                      0};
  std::vector<Samples> all;
  for (std::uint32_t tile = 0; tile < view.grid.count(); ++tile) {
    auto refined =
        refine_tile(cast, {view.epoch, {tile}, kNoStep, last}, nullptr, [] { return false; });
    all.push_back(std::move(refined->samples));
  }
  return all;
}

double known_share(const SampleArray& samples) {
  double known = 0, pixels = 0;
  for (const TileSamples& tile : samples.tiles())
    for (int y = 0; y < tile.rect().height; ++y)
      for (int x = 0; x < tile.rect().width; ++x, ++pixels)
        known += tile.known()[std::size_t(y * tile.stride() + x)] != 0 ? 1 : 0;
  return known / pixels;
}

BackEndRow measure(const BeginView& view, const std::vector<Samples>& samples, const char* name,
                   int repeats) {
  const Band band = band_of(view.grid, 0, 1);
  const ImageSize size = view.grid.image;
  const auto canvas = make_sample_canvas();
  canvas->begin_view(view, band);
  for (const Samples& message : samples) canvas->place(message);
  Present present;
  present.epoch = view.epoch;
  present.size = size;
  const PixelRect rect{0, 0, size.width, size.height};
  BackEndRow row;
  row.samples = name;
  const auto encoded = [&](bool lossless) {
    present.lossless = lossless;
    return time_of(repeats, [&] { canvas->encoded(present, rect); });
  };
  row.all_jpeg = encoded(false);
  row.all_zstd = encoded(true);

  // The parts: what is encoded is what was shown last.
  std::vector<std::uint8_t> rgb;
  if (view.update == Update::kAll) {
    SampleArray array(view.grid, band);
    for (const Samples& message : samples) array.place(message);
    row.known = known_share(array);
    const auto show = [&] {
      reconstruct_shown(array, Filter::kBilinear, view.background, view.color_space, rgb);
    };
    row.shown = time_of(repeats, show);
  } else {
    AgedBand aged(view, band);
    aged.begin_view(view.epoch, view.frame);
    for (const Samples& message : samples) aged.place(message);
    row.shown = time_of(repeats, [&] { aged.shown({}, view.background, view.color_space, rgb); });
  }
  Encoder encoder;
  row.jpeg = time_of(repeats, [&] { encoder.encode(rgb, size, Encoding::kJpeg); });
  row.zstd = time_of(repeats, [&] { encoder.encode(rgb, size, Encoding::kZstdRgb); });
  return row;
}

}  // namespace

std::vector<BackEndRow> measure_back_end(const Subject& subject, ImageSize size, int repeats) {
  const auto scene = commit_scene(subject.scene, subject.volume);
  std::vector<BackEndRow> rows;
  for (const Frame& frame : kFrames) {
    const BeginView view = view_of(subject, size, frame);
    rows.push_back(measure(view, samples_of(view, frame.last, scene), frame.name, repeats));
  }
  return rows;
}

}  // namespace goldthread::bench
