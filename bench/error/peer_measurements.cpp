// SPDX-License-Identifier: Apache-2.0
#include "bench/error/peer_measurements.h"

#include <fmt/format.h>

namespace goldthread::bench {
namespace {

constexpr double kGoalStep = 0.5;  // voxels

std::vector<double> vtk_steps(bool quick) {
  if (quick) return {kGoalStep};
  return {0.25, kGoalStep, 1, 2};
}

const char* mapper_of(Look look) {
  return look == Look::kIsosurface ? "vtkFlyingEdges3D" : "vtkFixedPointVolumeRayCastMapper";
}

}  // namespace

PeerMeasurements::PeerMeasurements(const Subject& subject, const ErrorBenchSettings& settings)
    : subject_(subject),
      settings_(settings),
      peer_settings_{settings.folder / "peers", settings.program, settings.threads} {
  std::filesystem::create_directories(peer_settings_.folder);
  try {
    job_.emplace(subject, peer_settings_);
    display_.emplace(peer_settings_.folder / "display.log");
    vtk_.emplace(*job_, peer_settings_, *display_);
    vtk_row_.version = vtk_->version();
  } catch (const PeerFailure& failure) {
    vtk_row_.failure = failure.what();
  }
}

std::vector<Contestant> PeerMeasurements::vtk_contestants() {
  std::vector<Contestant> contestants;
  if (!vtk_) return contestants;
  for (const Look look : {Look::kUnlit, Look::kPhong, Look::kMip}) {
    for (const double step : vtk_steps(settings_.quick)) {
      vtk_entries_.push_back({look, step});
      contestants.push_back({fmt::format("VTK {}", name_of(look)), [this, look, step] {
                               return vtk_->frame_seconds(look, step * subject_.voxel_mm,
                                                          subject_.scene.image.size);
                             }});
    }
  }
  return contestants;
}

std::optional<Contestant> PeerMeasurements::vtk_contestant(Look look, double step_voxels,
                                                           ImageSize size) {
  if (!vtk_) return {};
  return Contestant{"VTK", [this, look, step_mm = step_voxels * subject_.voxel_mm, size] {
                      return vtk_->frame_seconds(look, step_mm, size);
                    }};
}

std::optional<std::vector<Color>> PeerMeasurements::vtk_picture(Look look, double step_voxels,
                                                                ImageSize size, int stride) {
  if (!vtk_) return {};
  try {
    return vtk_->picture(look, step_voxels * subject_.voxel_mm, size, stride);
  } catch (const PeerFailure& failure) {
    vtk_row_.failure = failure.what();
    return {};
  }
}

MethodRow PeerMeasurements::aligned_row(const char* program, Look look, double step_voxels,
                                        const std::vector<Color>& picture,
                                        References& references) const {
  const ImageSize size = subject_.scene.image.size;
  MethodRow row;
  row.program = program;
  row.look = look;
  row.how = mapper_of(look);
  row.step_voxels = step_voxels;
  row.rays = std::uint64_t(size.width) * std::uint64_t(size.height);
  const Alignment best = references.align(look, picture);
  row.error = best.error;
  row.shift = best.shift;
  return row;
}

std::vector<MethodRow> PeerMeasurements::vtk_rows(const std::vector<Contestant>& contestants,
                                                  References& references) {
  std::vector<MethodRow> rows;
  for (std::size_t i = 0; i < contestants.size(); ++i) {
    const VtkEntry& entry = vtk_entries_[i];
    try {
      if (!contestants[i].failure.empty()) throw PeerFailure(contestants[i].failure);
      const auto picture = vtk_->picture(entry.look, entry.step_voxels * subject_.voxel_mm,
                                         subject_.scene.image.size, settings_.stride);
      rows.push_back(aligned_row("VTK", entry.look, entry.step_voxels, picture, references));
      rows.back().seconds = summarize(contestants[i].seconds);
    } catch (const PeerFailure& failure) {
      vtk_row_.failure = failure.what();
    }
  }
  return rows;
}

std::optional<MethodRow> PeerMeasurements::vtk_surface_row(References& references) {
  if (!vtk_) return {};
  try {
    const auto picture =
        vtk_->picture(Look::kIsosurface, 0, subject_.scene.image.size, settings_.stride);
    return aligned_row("VTK", Look::kIsosurface, 0, picture, references);
  } catch (const PeerFailure& failure) {
    vtk_row_.failure = failure.what();
    return {};
  }
}

std::optional<Contestant> PeerMeasurements::vtk_isovalue_contestant() {
  if (!vtk_) return {};
  return Contestant{
      "VTK", [this] { return vtk_->isovalue_seconds(subject_.next_isovalue, subject_.isovalue); }};
}

std::vector<Contestant> PeerMeasurements::start_contestants() {
  std::vector<Contestant> contestants;
  if (!vtk_) return contestants;
  const double step_mm = kGoalStep * subject_.voxel_mm;
  const auto job = job_->variant(Look::kUnlit, step_mm);
  contestants.push_back(
      {"VTK", [this, job] { return vtk_first_picture_seconds(job, peer_settings_, *display_); }});
  contestants.push_back(
      {"Goldthread",
       [this] { return own_first_picture_seconds(subject_.in(Look::kUnlit), peer_settings_); }});
  return contestants;
}

void PeerMeasurements::measure_paraview(OwnMethod& own, FrameCaster& caster, References& references,
                                        Report& report) {
  vtk_.reset();
  try {
    if (!job_ || !display_) throw PeerFailure(vtk_row_.failure);
    const auto own_frames = [&](std::vector<Contestant>& contestants) {
      run_rounds(contestants, settings_.repeats, in_phase(settings_, "beside ParaView"));
    };
    std::vector<Contestant> ours{{"Goldthread", [&] { return own.frame_seconds(caster); }}};
    own_frames(ours);
    const ParaViewFrames theirs =
        run_paraview(*job_, peer_settings_, settings_.repeats, subject_.scene.image.size,
                     settings_.stride, *display_);
    own_frames(ours);
    paraview_row_.version = theirs.version;
    MethodRow row = aligned_row("ParaView", Look::kUnlit, 0, theirs.picture, references);
    row.how = fmt::format("volume mapper \"{}\", {} ranks", theirs.mapper, kParaViewRanks);
    row.seconds = summarize(theirs.seconds);
    report.methods.push_back(row);
    report.latencies.push_back({"frame beside ParaView's", "ParaView", row.seconds});
    report.latencies.push_back(
        {"frame beside ParaView's", "Goldthread", summarize(ours.front().seconds)});
  } catch (const PeerFailure& failure) {
    paraview_row_.failure = failure.what();
  }
}

}  // namespace goldthread::bench
