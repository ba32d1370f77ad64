// SPDX-License-Identifier: Apache-2.0
// `goldthread bench motion`.

#include <spdlog/spdlog.h>

#include <cstdio>

#include "bench/motion/bench_motion.h"
#include "master/main/bench_setup.h"
#include "master/main/program.h"

namespace goldthread {
namespace {

/// The default head in motion: as large as a full frame can follow.
constexpr ImageSize kMotionSize{256, 256};

}  // namespace

int run_motion_bench(const Options& options) {
  const std::filesystem::path folder = report_folder(options.output);
  bench::MotionBenchSettings settings;
  settings.scene_name = scene_name(options);
  settings.threads = threads_of(options);
  settings.quick = options.bench.quick;
  if (options.bench.full_frame_ms)
    settings.full_frame_seconds = 1e-3 * *options.bench.full_frame_ms;
  Phases phases;
  settings.progress = [&](const std::string& what, double fraction) {
    phases.update(what, fraction);
  };

  bench::MotionReport report = bench::run_motion_bench(subject_of(options, kMotionSize), settings);
  phases.end();
  bench::write_motion_report(report, folder);
  std::fputs(bench::motion_text(report).c_str(), stdout);
  spdlog::info("bench: report.json and plots are in {}", folder.string());
  return 0;
}

}  // namespace goldthread
