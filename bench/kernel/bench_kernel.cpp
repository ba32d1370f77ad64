// SPDX-License-Identifier: Apache-2.0
// Frame times of the ray caster alone: one ray in each pixel's centre, tiles of 64×64 pixels taken
// by threads in turn. Prints one JSON object for vtk_fixed_point.py, which renders the same.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "common/tile/tile_grid.h"
#include "common/volume/build_volume.h"
#include "common/volume/volume_io.h"
#include "worker/ray_caster.h"

namespace {

using namespace goldthread;

constexpr int kTile = 64;

struct Options {
  std::string file = "/usr/share/mricron/templates/ch2.nii.gz";
  int size = 512;
  int threads = 2;
  int repeats = 7;
  double step_mm = 0.5;
  std::string pictures;  ///< prefix of files for the pictures; empty: none
};

Options options_of(int count, char** arguments) {
  Options options;
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string name = arguments[i];
    const char* value = arguments[i + 1];
    if (name == "--file") options.file = value;
    if (name == "--size") options.size = std::atoi(value);
    if (name == "--threads") options.threads = std::atoi(value);
    if (name == "--repeats") options.repeats = std::atoi(value);
    if (name == "--step") options.step_mm = std::atof(value);
    if (name == "--pictures") options.pictures = value;
  }
  return options;
}

// The default scene: the head from 36° of azimuth, far enough to be seen whole.
Scene default_scene(const VolumeGeometry& geometry, const Options& options) {
  const glm::dmat4 map = geometry.world_from_index();
  const glm::dvec4 last(glm::dvec3(geometry.size - 1), 1);
  const glm::dvec3 low(map[3]), high(map * last);
  const double azimuth = 36 * std::numbers::pi / 180;
  const double away = 0.5 * glm::length(high - low) / std::sin(15 * std::numbers::pi / 180);
  Camera camera;
  camera.target = 0.5 * (low + high);
  camera.position = camera.target + away * glm::dvec3(std::sin(azimuth), -std::cos(azimuth), 0);
  camera.up = {0, 0, 1};
  TransferFunction function;
  function.color = {
      {0, {0, 0, 0}}, {60, {0.8, 0.4, 0.3}}, {120, {0.95, 0.9, 0.8}}, {255, {1, 1, 1}}};
  function.opacity = {{0, 0}, {30, 0}, {60, 0.02}, {120, 0.15}, {255, 0.4}};
  SceneVolume volume;
  volume.transfer_function = function;
  Scene scene;
  scene.image.size = {options.size, options.size};
  scene.camera = camera;
  scene.step_mm = options.step_mm;
  scene.volumes = {volume};
  return scene;
}

// Positions tile by tile; a tile is kTile × kTile of them, in blocks of 4 × 4 as workers cast them.
std::vector<PixelPosition> tiled_positions(int size) {
  std::vector<PixelPosition> positions;
  for (int ty = 0; ty < size; ty += kTile)
    for (int tx = 0; tx < size; tx += kTile)
      for (const SampleOffset offset : new_samples(
               {std::min(kTile, size - tx), std::min(kTile, size - ty)}, kNoLevel, kPixelLevel))
        positions.push_back(position_of({tx, ty, kTile, kTile}, offset));
  return positions;
}

CastCounts render(const SampleSource& source, int threads, std::span<const PixelPosition> positions,
                  std::span<Sample> samples) {
  std::atomic<std::size_t> next{0};
  std::vector<CastCounts> counts(std::size_t(threads), CastCounts{});
  const auto work = [&](int thread) {
    constexpr std::size_t kChunk = kTile * kTile;
    for (std::size_t begin; (begin = next.fetch_add(kChunk)) < positions.size();) {
      const std::size_t count = std::min(kChunk, positions.size() - begin);
      counts[std::size_t(thread)] +=
          source.cast(positions.subspan(begin, count), samples.subspan(begin, count));
    }
  };
  {
    std::vector<std::jthread> pool;
    for (int i = 1; i < threads; ++i) pool.emplace_back(work, i);
    work(0);
  }
  CastCounts total;
  for (const CastCounts& c : counts) total += c;
  return total;
}

void write_picture(const std::string& file, std::span<const PixelPosition> positions,
                   std::span<const Sample> samples, int size) {
  std::vector<float> rgb(std::size_t(size) * std::size_t(size) * 3);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    float* pixel =
        &rgb[(std::size_t(positions[i].y) * std::size_t(size) + std::size_t(positions[i].x)) * 3];
    pixel[0] = samples[i].red, pixel[1] = samples[i].green, pixel[2] = samples[i].blue;
  }
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(rgb.data()),
             std::streamsize(rgb.size() * sizeof(float)));
}

std::string measure(const std::string& name, const Scene& scene,
                    const std::shared_ptr<const Volume>& volume, const Options& options) {
  const auto begin = std::chrono::steady_clock::now();
  const auto committed = commit_scene(scene, volume);
  const std::chrono::duration<double> commit = std::chrono::steady_clock::now() - begin;
  const auto source = make_ray_caster(committed, *scene.camera, scene.image.size);
  const auto positions = tiled_positions(options.size);
  std::vector<Sample> samples(positions.size());
  std::vector<double> seconds, processor;
  CastCounts counts;
  for (int i = 0; i < options.repeats; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t processor_start = std::clock();
    counts = render(*source, options.threads, positions, samples);
    seconds.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    processor.push_back(double(std::clock() - processor_start) / CLOCKS_PER_SEC);
  }
  if (!options.pictures.empty())
    write_picture(options.pictures + name + ".rgb32f", positions, samples, options.size);
  std::sort(seconds.begin(), seconds.end());
  std::sort(processor.begin(), processor.end());
  return fmt::format(
      R"("{}": {{"kernel": "{}", "median": {:.6f}, "cpu": {:.6f}, "commit": {:.6f}, "samples": {}}})",
      name, kernel_name(*committed), seconds[seconds.size() / 2], processor[processor.size() / 2],
      commit.count(), counts.samples);
}

std::string list_of(const glm::dvec3& v) { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); }

}  // namespace

int main(int count, char** arguments) {
  const Options options = options_of(count, arguments);
  const auto loaded = load_volume(options.file);
  if (!loaded) {
    fmt::print(stderr, "{}\n", loaded.failure().line());
    return 3;
  }
  const auto volume = build_volume(loaded.value().info, loaded.value().voxels());
  const VolumeGeometry& geometry = volume->info().geometry;
  const Scene scene = default_scene(geometry, options);
  Scene shaded = scene, mip = scene, surface = scene;
  shaded.volumes[0].shading = Shading{};
  mip.volumes[0].mode = Mode::kMip;
  surface.volumes[0].mode = Mode::kIsosurface;
  surface.volumes[0].shading = Shading{};
  surface.volumes[0].isosurfaces = {{80, {0.9, 0.8, 0.7}, 1}};

  // The camera as seen from the voxel grid: VTK's reader ignores the grid's place in the world.
  const glm::dmat3 to_grid = glm::transpose(geometry.direction);
  fmt::print(R"({{"file": "{}", "size": {}, "threads": {}, "step": {}, )", options.file,
             options.size, options.threads, options.step_mm);
  fmt::print(R"("position": {}, "target": {}, "up": {}, "fovy": {}, )",
             list_of(to_grid * (scene.camera->position - geometry.origin_mm)),
             list_of(to_grid * (scene.camera->target - geometry.origin_mm)),
             list_of(to_grid * scene.camera->up), scene.camera->fovy_deg);
  fmt::print("{}, {}, {}, {}}}\n", measure("unlit", scene, volume, options),
             measure("shaded", shaded, volume, options), measure("mip", mip, volume, options),
             measure("isosurface", surface, volume, options));
  return 0;
}
