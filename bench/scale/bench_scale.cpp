// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/bench_scale.h"

#include <fmt/format.h>

#include "bench/error/draw.h"
#include "bench/error/machine.h"
#include "bench/scale/record.h"
#include "common/scene/camera.h"
#include "worker/ray_caster.h"

namespace goldthread::bench {
namespace {

constexpr ImageSize kRecorded{1024, 1024}, kQuickRecorded{512, 512};
constexpr double kTurn = 2;      ///< degrees since the view before
constexpr double kClose = 0.45;  ///< of the distance
constexpr int kMasterWorkers[] = {16, 256, 1024, 4096};

Camera close_camera(Camera camera) {
  camera.position = camera.target + kClose * (camera.position - camera.target);
  return camera;
}

struct Recorder {
  std::shared_ptr<const CommittedScene> scene;
  ImageSettings image;
  int threads = 1;
  ScaleReport& report;

  CountedView count(const Camera& camera, const Casting& casting) const {
    return count_view(*make_ray_caster(scene, camera, image.size), image, casting, threads);
  }

  /// The view at a camera, and the one before it with the same prices: they differ by what was
  /// seen, not by what the machine did meanwhile.
  RecordedView record(const std::string& name, const Camera& camera, const std::string& work,
                      const Casting& casting) const {
    const CountedView now = count(camera, casting);
    CountedView before = count(orbit(camera, -kTurn), casting);
    const std::vector<LinearFit> prices = fit_steps(now);
    // One of the two may have needed a step more.
    before.steps.resize(now.steps.size(), before.steps.back());
    double us = 0;
    for (const auto& step : now.steps)
      for (const CountedStep& tile : step) us += tile.thread_us;
    report.views.push_back(name + ", " + work);
    report.prices.push_back(prices);
    report.thread_seconds.push_back(1e-6 * us);
    return {name, work, cost_record(now, prices), cost_record(before, prices)};
  }
};

std::vector<RecordedView> record_views(const Subject& subject, const ScaleBenchSettings& settings,
                                       ScaleReport& report) {
  Recorder recorder{commit_scene(subject.scene, subject.volume), subject.scene.image,
                    settings.threads, report};
  recorder.image.size = report.recorded_size;
  report.kernel = kernel_name(*recorder.scene);
  const Camera camera = *subject.scene.camera;
  constexpr const char* kWhole = "a ray in each pixel";
  constexpr const char* kRefined = "refined to 0.5";
  std::vector<RecordedView> views;
  const auto record = [&](const char* name, const Camera& at, const char* work,
                          const Casting& casting) {
    settings.progress("recording costs", double(views.size()) / 4);
    views.push_back(recorder.record(name, at, work, casting));
  };
  record("all in view", camera, kWhole, kWholeCasting);
  record("all in view", camera, kRefined, kRefinedCasting);
  if (settings.quick) return views;
  record("close", close_camera(camera), kWhole, kWholeCasting);
  record("close", close_camera(camera), kRefined, kRefinedCasting);
  return views;
}

/// Of links and roles. The model's link is the last one measured.
void measure_model(const Subject& subject, const ScaleBenchSettings& settings,
                   ScaleReport& report) {
  settings.progress("timing messages", 0);
  report.links.push_back(time_loopback(settings.quick));
  settings.progress("timing messages", 0.5);
  if (auto mpi = settings.time_mpi())
    report.links.push_back(*mpi);
  else
    report.notes.push_back(mpi.failure().line());
  report.model.link = fit_link(report.links.back()).costs;
  for (const int workers : kMasterWorkers) {
    settings.progress("timing a master", double(report.model.master.size()) / 4);
    report.model.master.push_back(measure_master(subject, workers));
  }
  const PlacingCosts placing = measure_placing();
  report.model.place = placing.place;
  report.placing_residual = placing.residual;
}

void simulate_all(const std::vector<RecordedView>& views, const ScaleBenchSettings& settings,
                  ScaleReport& report) {
  SweepSettings sweep;
  sweep.threads = settings.threads;
  if (settings.quick) sweep.workers = {1, 4, 16, 64, 256, 1024, 4096};
  const auto told = [&](const std::string& what) {
    sweep.progress = [&settings, what](double fraction) { settings.progress(what, fraction); };
  };
  told("simulating one master");
  report.one_level = sweep_one_level(views, report.model, sweep);
  told("simulating two levels");
  report.two_levels = sweep_two_levels(views, report.model, sweep);
  sweep.progress = [](double) {};
  for (const int megapixels : sweep.megapixels) {
    const SweepPoint* plan = second_level(report.two_levels, 0, megapixels, kGoal);
    if (plan == nullptr) continue;
    const auto points = sweep_like(*plan, views, report.model, sweep);
    report.with_second_level.insert(report.with_second_level.end(), points.begin(), points.end());
  }
}

}  // namespace

ScaleReport run_scale_bench(const Subject& subject, const ScaleBenchSettings& settings) {
  ScaleReport report;
  report.version = GOLDTHREAD_VERSION;
  report.date = date_now();
  report.machine = this_machine();
  report.scene = settings.scene_name;
  report.recorded_size = settings.quick ? kQuickRecorded : kRecorded;
  const std::vector<RecordedView> views = record_views(subject, settings, report);
  measure_model(subject, settings, report);

  ClusterModel threads = report.model;
  threads.link = fit_link(report.links.front()).costs;
  ValidationSettings validation;
  validation.threads = settings.threads;
  validation.quick = settings.quick;
  validation.progress = [&](double fraction) { settings.progress("validating", fraction); };
  report.validation = validate(subject, views.front().now, threads, validation);

  simulate_all(views, settings, report);
  return report;
}

void write_scale_report(ScaleReport& report, const std::filesystem::path& folder) {
  std::string missing;
  for (const Plot& plot : scale_plots(report))
    if (const std::string why = draw(plot, folder); !why.empty()) missing = why;
  if (!missing.empty())
    report.notes.push_back(fmt::format("no plots: {} (launch/peers installs gnuplot)", missing));
  write_text(folder / "report.md", scale_markdown(report));
  write_text(folder / "report.json", scale_json(report));
}

}  // namespace goldthread::bench
