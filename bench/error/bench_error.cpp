// SPDX-License-Identifier: Apache-2.0
#include "bench/error/bench_error.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/error/adaptive_measurements.h"
#include "bench/error/draw.h"
#include "bench/error/machine.h"
#include "bench/error/own_measurements.h"
#include "bench/error/peer_measurements.h"
#include "bench/error/plots.h"
#include "worker/kernels/kernel_table.h"

namespace goldthread::bench {
namespace {

Report report_head(const Subject& subject, const ErrorBenchSettings& settings) {
  const VolumeInfo& info = subject.volume->info();
  const glm::ivec3 size = info.geometry.size;
  Report report;
  report.version = GOLDTHREAD_VERSION;
  report.date = date_now();
  report.machine = this_machine();
  report.instruction_set = instruction_set();
  report.scene = settings.scene_name;
  report.volume =
      fmt::format("{}, {}×{}×{} {}", info.file, size.x, size.y, size.z, name_of(info.type));
  report.default_scene = subject.is_default;
  report.size = subject.scene.image.size;
  report.threads = settings.threads;
  report.repeats = settings.repeats;
  report.stride = settings.stride;
  report.quick = settings.quick;
  report.voxel_mm = subject.voxel_mm;
  report.isovalue = subject.isovalue;
  report.next_isovalue = subject.next_isovalue;
  return report;
}

/// Every look and step of ours, the bare loop, and VTK, in the same rounds.
void measure_methods(const Subject& subject, const ErrorBenchSettings& settings,
                     FrameCaster& caster, References& references, PeerMeasurements* peers,
                     Report& report) {
  std::vector<OwnEntry> entries = own_entries(subject, own_steps(settings.quick));
  std::vector<Contestant> contestants;
  contestants.reserve(entries.size() + 1);
  for (OwnEntry& entry : entries)
    contestants.push_back({"", [&] { return entry.method.frame_seconds(caster); }});
  contestants.push_back(gather_contestant(subject, settings.threads));
  const std::size_t own_count = contestants.size();
  if (peers != nullptr) {
    for (Contestant& contestant : peers->vtk_contestants())
      contestants.push_back(std::move(contestant));
  }
  run_rounds(contestants, settings.repeats, in_phase(settings, "frames"));
  report.methods = own_rows(entries, contestants, caster, references, settings);
  report.gathers.push_back(gather_row(contestants[own_count - 1], settings.threads));
  if (peers == nullptr) return;
  const auto theirs = peers->vtk_rows(
      {contestants.begin() + std::ptrdiff_t(own_count), contestants.end()}, references);
  report.methods.insert(report.methods.end(), theirs.begin(), theirs.end());
  if (const auto surface = peers->vtk_surface_row(references)) report.methods.push_back(*surface);
}

void add_latencies(const std::string& what, std::vector<Contestant>& contestants, int rounds,
                   const ErrorBenchSettings& settings, Report& report) {
  if (contestants.empty()) return;
  run_rounds(contestants, rounds, in_phase(settings, what));
  for (const Contestant& contestant : contestants) {
    if (contestant.failure.empty())
      report.latencies.push_back({what, contestant.name, summarize(contestant.seconds)});
    else
      report.notes.push_back(fmt::format("{}, {}: {}", what, contestant.name, contestant.failure));
  }
}

void measure_latencies(const Subject& subject, const ErrorBenchSettings& settings,
                       FrameCaster& caster, PeerMeasurements* peers, Report& report) {
  std::vector<Contestant> isovalue{isovalue_contestant(subject, caster)};
  if (peers != nullptr) {
    if (auto vtk = peers->vtk_isovalue_contestant()) isovalue.push_back(std::move(*vtk));
  }
  add_latencies("new isovalue", isovalue, settings.repeats, settings, report);
  if (peers == nullptr) return;
  std::vector<Contestant> start = peers->start_contestants();
  add_latencies("start", start, settings.repeats, settings, report);
}

/// Each reference is held against the least error that was measured with it.
std::vector<ReferenceRow> reference_rows(const References& references, const Report& report) {
  std::vector<ReferenceRow> rows = references.rows();
  for (ReferenceRow& row : rows) {
    row.smallest_error = std::numeric_limits<double>::infinity();
    for (const MethodRow& method : report.methods)
      if (method.look == row.look)
        row.smallest_error = std::min(row.smallest_error, method.error.rms);
  }
  return rows;
}

void note_unconverged(Report& report) {
  for (const ReferenceRow& row : report.references) {
    if (!row.is_converged())
      report.notes.push_back(fmt::format(
          "the reference ({}) moves by {}/255 when its substeps are doubled, more than a tenth of "
          "the least error measured against it",
          name_of(row.look), number(row.doubled)));
  }
}

}  // namespace

std::function<void(double)> in_phase(const ErrorBenchSettings& settings, std::string what) {
  return
      [&settings, what = std::move(what)](double fraction) { settings.progress(what, fraction); };
}

Report run_error_bench(const Subject& subject, const ErrorBenchSettings& settings) {
  Report report = report_head(subject, settings);
  report.memory = measure_memory(subject);
  References references(subject, settings);
  for (const Look look : kLooks) references.of(look);
  FrameCaster caster(subject.scene.image.size, settings.threads);
  std::optional<PeerMeasurements> peers;
  if (settings.peers) peers.emplace(subject, settings);
  PeerMeasurements* const present = peers ? &*peers : nullptr;
  measure_methods(subject, settings, caster, references, present, report);
  measure_latencies(subject, settings, caster, present, report);
  measure_adaptive(subject, settings, present, report);
  report.storages = measure_storages(subject, settings, caster);
  report.features = measure_features(subject, settings, caster);
  if (settings.all_instruction_sets) {
    const auto sets = instruction_sets();
    for (const std::string& name : sets)
      if (name != report.instruction_set)
        measure_instruction_set(name, subject, settings, references, caster, report);
  }
  if (peers) {
    OwnMethod own(subject.in(Look::kUnlit), subject.volume);
    peers->measure_paraview(own, caster, references, report);
    report.peers = peers->rows();
  }
  report.references = reference_rows(references, report);
  note_unconverged(report);
  return report;
}

void write_report(Report& report, const std::filesystem::path& folder) {
  std::string missing;
  for (const Plot& plot : plots_of(report))
    if (const std::string why = draw(plot, folder); !why.empty()) missing = why;
  if (!missing.empty())
    report.notes.push_back(fmt::format("no plots: {} (launch/peers installs gnuplot)", missing));
  write_text(folder / "report.json", report_json(report));
  write_text(folder / "report.md", report_markdown(report));
}

}  // namespace goldthread::bench
