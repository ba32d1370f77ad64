// SPDX-License-Identifier: Apache-2.0
#include "bench/error/adaptive_measurements.h"

#include <fmt/format.h>

#include <algorithm>

#include "worker/kernels/scene_terms.h"

namespace goldthread::bench {
namespace {

/// Measured: 64 pixels leave threads less to wait for at the end of a step than 128.
constexpr int kTile = 64;
/// VTK's own error, at which the steps of rays are compared.
constexpr double kStepsTarget = 2.4;
constexpr double kVtkStep = 0.5;  // voxels
/// The truth is computed on every n-th pixel. Odd: all places of the refinement's grids are met
/// equally often.
constexpr int kStride = 3;
constexpr int kLargeStride = 5;
constexpr int kQuickStride = 17;
/// Beyond so many pixels a picture is large.
constexpr int kManyPixels = 1 << 19;
constexpr Step kFirstPictures[] = {{1}, {2}};

std::vector<double> targets(bool quick) {
  if (quick) return {kStepsTarget, 0.5};
  return {10, 5, kStepsTarget, 1, 0.5, 0.25};
}

int stride_for(ImageSize size, bool quick) {
  if (quick) return kQuickStride;
  return size.width * size.height < kManyPixels ? kStride : kLargeStride;
}

Features features_in(const Scene& scene) {
  return features_of(scene.volumes.front(), scene.lights);
}

/// `subject` with pictures of another size.
Subject resized(Subject subject, ImageSize size) {
  subject.scene.image.size = size;
  return subject;
}

}  // namespace

AdaptiveMeasurements::AdaptiveMeasurements(const Subject& subject, ImageSize size,
                                           const ErrorBenchSettings& settings,
                                           PeerMeasurements* peers)
    : subject_(resized(subject, size)),
      settings_(settings),
      peers_(peers),
      caster_(size, settings.threads, kTile),
      frames_(size, settings.threads),
      stride_(stride_for(size, settings.quick)) {}

double AdaptiveMeasurements::step_for(Look look, double target) const {
  const VolumeGeometry& geometry = subject_.volume->info().geometry;
  return step_for_error(target, geometry, features_in(subject_.in(look))) / subject_.voxel_mm;
}

void AdaptiveMeasurements::add(Look look, double target, double step_voxels, const Aim& aim) {
  entries_.push_back(
      {look, target, step_voxels,
       AdaptiveMethod(subject_.in(look, step_voxels * subject_.voxel_mm), subject_.volume, aim)});
  AdaptiveMethod& method = entries_.back().method;
  contestants_.push_back({"", [&] { return method.frame_seconds(caster_); }});
}

void AdaptiveMeasurements::add_every_pixel() {
  for (const Look look : kLooks) {
    OwnMethod& method = every_pixel_.emplace_back(subject_.in(look), subject_.volume);
    contestants_.push_back({"", [&] { return method.frame_seconds(frames_); }});
  }
}

void AdaptiveMeasurements::add_vtk() {
  if (peers_ == nullptr) return;
  for (const Look look : {Look::kUnlit, Look::kPhong, Look::kMip}) {
    auto vtk = peers_->vtk_contestant(look, kVtkStep, subject_.scene.image.size);
    if (!vtk) continue;
    vtk_.push_back(look);
    contestants_.push_back(std::move(*vtk));
  }
}

void AdaptiveMeasurements::run_rounds(const char* what) {
  const ImageSize size = subject_.scene.image.size;
  bench::run_rounds(contestants_, settings_.repeats,
                    in_phase(settings_, fmt::format("{}, {}×{}", what, size.width, size.height)));
}

const std::vector<Color>& AdaptiveMeasurements::truth(Look look, Shift shift) {
  const auto key = std::tuple{look, shift.x, shift.y};
  if (const auto known = truths_.find(key); known != truths_.end()) return known->second;
  const Scene scene = subject_.in(look);
  const double step = step_of(0, subject_.volume->info().geometry, features_in(scene));
  const auto committed = commit_scene(subject_.in(look, 0.5 * step), subject_.volume);
  const auto source = make_ray_caster(committed, *scene.camera, scene.image.size);
  Truth truth;
  const double seconds = seconds_of([&] {
    truth = filtered_truth({*source,
                            scene.image,
                            {scene.image.size, stride_},
                            shift,
                            settings_.threads,
                            in_phase(settings_, fmt::format("truth, {}", name_of(look)))});
  });
  if (shift == Shift{})
    truth_rows_.push_back(
        {look, scene.image.size, stride_, truth.rays_per_pixel, truth.coarser, seconds});
  return truths_[key] = std::move(truth.colors);
}

double AdaptiveMeasurements::error_of(AdaptiveMethod& method, Look look) {
  method.frame_seconds(caster_);
  return picture_error(caster_.shown(method.image(), stride_), truth(look)).rms;
}

AdaptiveRow AdaptiveMeasurements::row_of(std::size_t i) {
  Entry& entry = entries_[i];
  AdaptiveRow row;
  row.look = entry.look;
  row.size = subject_.scene.image.size;
  row.target = entry.target;
  row.step_voxels = entry.step_voxels;
  row.seconds = summarize(contestants_[i].seconds);
  row.rms = error_of(entry.method, entry.look);
  row.cpu_seconds = entry.method.cpu_seconds();
  row.cast_seconds = entry.method.cast_seconds(caster_, settings_.repeats / 3 + 1);
  row.steps = entry.method.refined().step.value;
  row.rays = entry.method.refined().rays;
  row.estimated = entry.method.estimated_rms();
  return row;
}

void AdaptiveMeasurements::add_every_pixel_rows(AdaptiveReport& report) {
  for (std::size_t i = 0; i < every_pixel_.size(); ++i) {
    every_pixel_[i].frame_seconds(frames_);
    const auto shown = frames_.shown(subject_.scene.image, stride_);
    report.every_pixel.push_back({"Goldthread", kLooks[i], subject_.scene.image.size, 0,
                                  summarize(contestants_[entries_.size() + i].seconds),
                                  picture_error(shown, truth(kLooks[i])).rms});
  }
}

void AdaptiveMeasurements::add_vtk_rows(Report& report) {
  const std::size_t first = entries_.size() + every_pixel_.size();
  const ImageSize size = subject_.scene.image.size;
  for (std::size_t i = 0; i < vtk_.size(); ++i) {
    const Contestant& contestant = contestants_[first + i];
    const auto shown = peers_->vtk_picture(vtk_[i], kVtkStep, size, stride_);
    if (!contestant.failure.empty() || !shown) continue;
    const MethodRow* aligned = report.find("VTK", vtk_[i], kVtkStep, "");
    const Shift shift = aligned && aligned->shift ? *aligned->shift : Shift{};
    report.adaptive.every_pixel.push_back({"VTK", vtk_[i], size, kVtkStep,
                                           summarize(contestant.seconds),
                                           picture_error(*shown, truth(vtk_[i], shift)).rms});
  }
}

void AdaptiveMeasurements::measure(Report& report) {
  for (const Look look : kLooks) {
    for (const double target : targets(settings_.quick))
      add(look, target, step_for(look, target), Aim::at_error(target));
    for (const Step step : kFirstPictures)
      add(look, 0, step_for(look, kStepsTarget), Aim::at_step(step));
  }
  add_every_pixel();
  add_vtk();
  run_rounds("adaptive");
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const AdaptiveRow row = row_of(i);
    if (row.target > 0)
      report.adaptive.rows.push_back(row);
    else
      report.adaptive.first_pictures.push_back(
          {row.look, row.size, row.steps, row.seconds, row.rms});
  }
  add_every_pixel_rows(report.adaptive);
  add_vtk_rows(report);
}

void AdaptiveMeasurements::measure_ray_steps(AdaptiveReport& report) {
  entries_.clear();
  every_pixel_.clear();
  vtk_.clear();
  contestants_.clear();
  for (const Look look : kLooks)
    for (const double step : {0.0, 0.5, 1.0, 2.0})
      add(look, kStepsTarget, step, Aim::at_error(kStepsTarget));
  run_rounds("steps of rays");
  for (std::size_t i = 0; i < entries_.size(); ++i) report.ray_steps.push_back(row_of(i));
}

void AdaptiveMeasurements::measure_calibration(AdaptiveReport& report) {
  constexpr int kMostSteps = 16;
  const double least = settings_.quick ? 1 : 0.2;
  const auto size = subject_.scene.image.size;
  for (const Look look : kLooks) {
    double estimated = 255;
    for (int step = 1; step <= kMostSteps && estimated > least; ++step) {
      AdaptiveMethod method(subject_.in(look), subject_.volume,
                            Aim::at_step({static_cast<std::uint16_t>(step)}));
      const double rms = error_of(method, look);
      estimated = method.estimated_rms();
      const double pixels = double(size.width) * size.height;
      report.calibration.push_back(
          {look, step, double(method.refined().rays) / pixels, estimated, rms});
    }
  }
}

void measure_adaptive(const Subject& subject, const ErrorBenchSettings& settings,
                      PeerMeasurements* peers, Report& report) {
  report.adaptive.tile_px = kTile;
  report.adaptive.steps_target = kStepsTarget;
  const ImageSize size = subject.scene.image.size;
  const auto add_truths = [&](const AdaptiveMeasurements& measured) {
    for (const TruthRow& row : measured.truths()) report.adaptive.truths.push_back(row);
  };
  AdaptiveMeasurements same(subject, size, settings, peers);
  same.measure(report);
  same.measure_ray_steps(report.adaptive);
  same.measure_calibration(report.adaptive);
  add_truths(same);
  AdaptiveMeasurements twice(subject, {2 * size.width, 2 * size.height}, settings, peers);
  twice.measure(report);
  add_truths(twice);
}

}  // namespace goldthread::bench
