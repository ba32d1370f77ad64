// SPDX-License-Identifier: Apache-2.0
#include "bench/throughput/bench_throughput.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/error/draw.h"
#include "bench/error/machine.h"
#include "bench/error/process.h"

namespace goldthread::bench {
namespace {

constexpr Carrier kCarriers[] = {Carrier::kSharedMemory, Carrier::kTcp, Carrier::kThreads};
constexpr ImageSize kBackEndSize{1024, 1024};
constexpr int kBackEndRepeats = 21, kQuickBackEndRepeats = 5;
constexpr int kSmallTile = 16;
/// A virtual machine's cores may be neighbours at one time and far apart at another, with six times
/// as long for a copy.
constexpr std::size_t kRounds = 3, kQuickRounds = 1;

std::vector<int> sides(bool quick) {
  return quick ? std::vector{256, 1024} : std::vector{128, 256, 512, 1024, 2048};
}

std::vector<int> worker_counts(bool quick) {
  return quick ? std::vector{1, 8} : std::vector{1, 2, 4, 8, 16};
}

RanksSetup setup_of(Carrier carrier, int side, int workers, const char* bypass) {
  RanksSetup setup;
  setup.carrier = carrier;
  setup.size = {side, side};
  setup.workers = workers;
  setup.bypass = bypass;
  return setup;
}

std::vector<RanksSetup> bypassed_setups(bool quick) {
  std::vector<RanksSetup> setups;
  for (const Carrier carrier : kCarriers)
    for (const int side : sides(quick))
      setups.push_back(setup_of(carrier, side, 1, "master,worker,compositor"));
  return setups;
}

/// A session's frame in squares of 64, and one in so many that nothing but the master is measured.
std::vector<RanksSetup> master_setups(bool quick) {
  std::vector<RanksSetup> setups;
  for (const Carrier carrier : {Carrier::kSharedMemory, Carrier::kThreads})
    for (const int tile : {64, kSmallTile})
      for (const int workers : worker_counts(quick)) {
        setups.push_back(setup_of(carrier, 512, workers, "worker,compositor"));
        setups.back().tile_px = tile;
      }
  return setups;
}

std::vector<RanksSetup> back_end_setups(bool quick) {
  std::vector<RanksSetup> setups;
  for (const int side : sides(quick))
    setups.push_back(setup_of(Carrier::kSharedMemory, side, 1, "master,worker"));
  return setups;
}

/// Starts one cluster after the other; what fails is noted once for each reason.
class Measurements {
 public:
  Measurements(const ThroughputBenchSettings& settings, std::vector<std::string>& notes)
      : settings_(settings),
        starter_({settings.program, settings.folder / "ranks", settings.scene, settings.quick}),
        notes_(notes) {}

  std::vector<FramesRow> rows(const char* what, const std::vector<RanksSetup>& setups,
                              bool with_stream) {
    std::vector<FramesRow> rows;
    for (std::size_t i = 0; i < setups.size(); ++i) {
      settings_.progress(what, double(i) / double(setups.size()));
      try {
        rows.push_back(row(setups[i], with_stream && is_mpi(setups[i].carrier)));
      } catch (const PeerFailure& failure) {
        note(fmt::format("{}: {}", name_of(setups[i].carrier), failure.what()));
      }
    }
    return rows;
  }

 private:
  FramesRow row(const RanksSetup& setup, bool with_stream) const {
    if (!with_stream) return {setup, starter_.frames(setup), {}, {}};
    std::vector<FramesRow> rounds(settings_.quick ? kQuickRounds : kRounds);
    for (FramesRow& each : rounds) each = round(setup);
    return middle_of(std::move(rounds));
  }
  /// MPI alone before and after, so that what else the machine does strikes both alike.
  FramesRow round(const RanksSetup& setup) const {
    FramesRow row{setup, {}, starter_.stream(setup), {}};
    row.frames = starter_.frames(setup);
    const StreamResult after = starter_.stream(setup);
    row.stream->seconds.insert(row.stream->seconds.end(), after.seconds.begin(),
                               after.seconds.end());
    return row;
  }
  void note(const std::string& text) {
    if (std::find(notes_.begin(), notes_.end(), text) == notes_.end()) notes_.push_back(text);
  }

  const ThroughputBenchSettings& settings_;
  RanksStarter starter_;
  std::vector<std::string>& notes_;
};

}  // namespace

ThroughputReport run_throughput_bench(const Subject& subject,
                                      const ThroughputBenchSettings& settings) {
  const bool quick = settings.quick;
  ThroughputReport report;
  report.version = GOLDTHREAD_VERSION;
  report.date = date_now();
  report.machine = this_machine();
  report.scene = settings.scene_name;
  report.back_end_size = kBackEndSize;
  Measurements measurements(settings, report.notes);
  report.bypassed = measurements.rows("everything by-passed", bypassed_setups(quick), true);
  report.master = measurements.rows("the master alone", master_setups(quick), false);
  report.back_end = measurements.rows("the back end alone", back_end_setups(quick), false);
  settings.progress("the parts of the back end", 0);
  report.parts =
      measure_back_end(subject, kBackEndSize, quick ? kQuickBackEndRepeats : kBackEndRepeats);
  return report;
}

void write_throughput_report(ThroughputReport& report, const std::filesystem::path& folder) {
  std::string missing;
  for (const Plot& plot : throughput_plots(report))
    if (const std::string why = draw(plot, folder); !why.empty()) missing = why;
  if (!missing.empty())
    report.notes.push_back(fmt::format("no plots: {} (launch/peers installs gnuplot)", missing));
  write_text(folder / "report.md", throughput_markdown(report));
  write_text(folder / "report.json", throughput_json(report));
}

}  // namespace goldthread::bench
