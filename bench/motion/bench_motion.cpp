// SPDX-License-Identifier: Apache-2.0
#include "bench/motion/bench_motion.h"

#include <fmt/format.h>

#include "bench/error/draw.h"
#include "bench/error/machine.h"
#include "bench/motion/methods.h"

namespace goldthread::bench {
namespace {

constexpr double kQuickSeconds = 1;
constexpr int kMeasuredFrames = 9;

/// The time that a full frame takes on the whole machine.
double frame_seconds(const MotionScene& scene) {
  std::vector<double> seconds(kMeasuredFrames);
  for (double& each : seconds) each = scene.shared(full_frame(scene, scene.rest).seconds);
  return median(std::move(seconds));
}

MotionReport report_head(const MotionScene& scene, const MotionBenchSettings& settings) {
  MotionReport report;
  report.version = GOLDTHREAD_VERSION;
  report.date = date_now();
  report.machine = this_machine();
  report.kernel = kernel_name(*scene.committed);
  report.scene = settings.scene_name;
  report.size = scene.image.size;
  report.threads = scene.threads;
  report.full_frame_seconds = frame_seconds(scene);
  return report;
}

}  // namespace

MotionReport run_motion_bench(const Subject& subject, const MotionBenchSettings& settings) {
  MotionScene scene = motion_scene(subject, settings.threads);
  MotionReport report = report_head(scene, settings);
  if (settings.full_frame_seconds)
    scene.cost_factor = *settings.full_frame_seconds / report.full_frame_seconds;
  report.cost_factor = scene.cost_factor;
  const auto exact = [&](const Camera& camera) { return true_picture(scene, camera); };
  for (const CameraPath& path : camera_paths(scene.rest)) {
    PlaybackSettings playback;
    playback.seconds = settings.quick ? kQuickSeconds : kPathSeconds;
    playback.threads = settings.threads;
    playback.progress = [&](double fraction) { settings.progress(path.name, fraction); };
    const auto methods = all_methods(scene);
    const std::vector<Showing> showings = play(path, methods, exact, playback);
    report.paths.emplace_back(path.name, path.about);
    for (std::size_t i = 0; i < methods.size(); ++i)
      report.rows.push_back({path.name, methods[i]->name(), showings[i]});
  }
  return report;
}

void write_motion_report(MotionReport& report, const std::filesystem::path& folder) {
  std::string missing;
  for (const Plot& plot : motion_plots(report))
    if (const std::string why = draw(plot, folder); !why.empty()) missing = why;
  if (!missing.empty())
    report.notes.push_back(fmt::format("no plots: {} (launch/peers installs gnuplot)", missing));
  write_text(folder / "report.md", motion_markdown(report));
  write_text(folder / "report.json", motion_json(report));
}

}  // namespace goldthread::bench
