// SPDX-License-Identifier: Apache-2.0
// `goldthread render`: one image, or a sequence.

#include <spdlog/spdlog.h>

#include <fstream>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/image/display.h"
#include "common/image/image_file.h"
#include "common/image/sequence_path.h"
#include "common/image/whole_file.h"
#include "common/scene/camera.h"
#include "common/scene/resolve.h"
#include "common/scene/scene_file.h"
#include "master/cost_picture.h"
#include "master/main/bypass.h"
#include "master/main/program.h"
#include "master/main/progress.h"
#include "master/main/scene_setup.h"
#include "master/render_job.h"
#include "master/report.h"

namespace goldthread {
namespace {

/// Of a cost image's colours.
constexpr const char* kCostScaleKey = "goldthread:costScale";

/// Where the frames go; checked before anything is computed.
class Output {
 public:
  Output(const std::string& place, bool is_sequence) {
    if (is_sequence)
      pattern_ = value_or_throw(SequencePath::parse(place));
    else
      single_ = place;
    value_or_throw(image_path(path(0).string()));
  }
  /// Whether a frame has no place is found before the first is computed.
  void expect_writable(int frames) const {
    std::set<std::filesystem::path> folders;
    for (int i = 0; i < frames; ++i) {
      if (folders.insert(path(i).parent_path()).second) goldthread::expect_writable(path(i));
    }
  }
  std::filesystem::path path(int frame) const { return pattern_ ? pattern_->at(frame) : single_; }

 private:
  std::optional<SequencePath> pattern_;
  std::string single_;
};

void write_frame(const std::filesystem::path& path, const Scene& scene,
                 const RenderedFrame& frame) {
  const ImageMetadata metadata{{kSceneKey, scene_to_json(scene)},
                               {kCameraKey, camera_to_json(*scene.camera)},
                               {kSoftwareKey, std::string("goldthread ") + GOLDTHREAD_VERSION}};
  if (is_float_image(path)) {
    write_rgba32f(path, frame.size, frame.rgba, metadata);
  } else {
    write_rgb8(path, frame.size, display_rgb8(frame.rgba, scene.image.color_space), metadata);
  }
}

void write_cost(const std::filesystem::path& path, const ViewState& view) {
  const ImageMetadata metadata{{kCostScaleKey, cost_scale(view)},
                               {kSoftwareKey, std::string("goldthread ") + GOLDTHREAD_VERSION}};
  if (can_be_float_image(path))
    write_grey32f(path, view.grid.image, cost_per_pixel(view), metadata);
  else
    write_rgb8(path, view.grid.image, cost_rgb8(view), metadata);
  spdlog::info("{}: {}", path.string(), cost_scale(view));
}

/// A pipe, a terminal and what a link like /dev/stdout names are written as they are; only a file
/// can be replaced as a whole.
bool is_stream(const std::filesystem::path& path) {
  std::error_code none;
  return std::filesystem::is_other(path, none) || std::filesystem::is_symlink(path, none);
}

void expect_report_writable(const std::string& path) {
  if (!is_stream(path)) expect_writable(path);
}

void write_report(Cluster& cluster, const Options& options, const std::vector<ViewState>& frames,
                  double load_seconds) {
  const std::string& path = *options.report;
  cluster.request_counters();
  while (!cluster.counters_complete()) cluster.poll(std::chrono::milliseconds(20));
  const std::string report = report_json(cluster, frames, load_seconds, names_of(options.bypass));
  if (!is_stream(path)) {
    write_whole_file(path, {reinterpret_cast<const unsigned char*>(report.data()), report.size()});
    return;
  }
  std::ofstream file(path);
  file << report;
  file.close();
  if (!file) {
    throw FatalError({path, "cannot be written", "choose another place with --report",
                      ExitStatus::kClusterFailed});
  }
}

std::string count_of(std::uint64_t number) {
  return number < 10'000'000 ? fmt::format("{:.0f} k", 1e-3 * static_cast<double>(number))
                             : fmt::format("{:.1f} M", 1e-6 * static_cast<double>(number));
}

}  // namespace

void run_render(Cluster& cluster, const Options& options) {
  const Output output(options.output, options.orbit.has_value());
  const Orbit orbit = options.orbit.value_or(Orbit{1, 0});
  output.expect_writable(orbit.frames);
  std::optional<Output> costs;
  if (options.cost_image) {
    if (*options.cost_image == options.output)
      throw FatalError({"--cost-image", "names the place of the picture itself",
                        "choose another place", ExitStatus::kUsage});
    costs.emplace(*options.cost_image, options.orbit.has_value());
    costs->expect_writable(orbit.frames);
  }
  if (options.report) expect_report_writable(*options.report);
  Scene scene = scene_of(options);
  const auto begin = Clock::now();
  {
    Progress progress("reading " + scene.volumes.front().file.filename().string());
    const VolumeInfo info = cluster.load_volume(
        scene.volumes.front(), [&](double fraction) { progress.update(fraction); });
    log_volume(info);
    scene = resolve_scene(scene, info);
    scene.step_mm = step_of(scene, info, stop_rule_of(options));
  }
  const double load_seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  cluster.commit(scene);

  RenderRequest request;
  request.stop = stop_rule_of(options);
  request.cut = cut_of(tile_choice_of(options), scene.image.size, request.stop.sampling,
                       Update::kAll, cluster.threads());
  request.filter = options.filter;
  if (options.time_s) request.time = std::chrono::duration<double>(*options.time_s);
  request.interrupted = interrupted;
  request.worker_lost = log_lost_worker;
  const Camera first = *scene.camera;
  std::vector<ViewState> views;
  Progress progress("rendering");
  for (int i = 0; i < orbit.frames; ++i) {
    request.progress = [&](double fraction) { progress.update((i + fraction) / orbit.frames); };
    scene.camera = goldthread::orbit(first, i * orbit.degrees / orbit.frames);
    RenderedFrame frame = render_frame(cluster, scene, request);
    write_frame(output.path(i), scene, frame);
    if (costs) write_cost(costs->path(i), frame.view);
    const StepState* shown = frame.view.shown();
    spdlog::info("{}: {}×{}, error ± {:.2f}/255, {} rays ({:.2f} a pixel), {:.0f} ms",
                 output.path(i).string(), frame.size.width, frame.size.height,
                 estimated_error(frame.view), count_of(frame.view.rays),
                 double(frame.view.rays) / frame.view.pixels(), 1e3 * shown->held.count());
    views.push_back(std::move(frame.view));
  }
  if (options.report) write_report(cluster, options, views, load_seconds);
}

}  // namespace goldthread
