// SPDX-License-Identifier: Apache-2.0
// `goldthread bench throughput`.

#include <spdlog/spdlog.h>

#include <cstdio>

#include "bench/throughput/bench_throughput.h"
#include "master/main/bench_setup.h"
#include "master/main/program.h"

namespace goldthread {

int run_throughput_bench(const Options& options) {
  bench::ThroughputBenchSettings settings;
  settings.folder = report_folder(options.output);
  settings.program = std::filesystem::read_symlink("/proc/self/exe");
  settings.scene = options.input;
  settings.scene_name = scene_name(options);
  settings.quick = options.bench.quick;
  Phases phases;
  settings.progress = [&](const std::string& what, double fraction) {
    phases.update(what, fraction);
  };

  bench::ThroughputReport report = bench::run_throughput_bench(subject_of(options), settings);
  phases.end();
  bench::write_throughput_report(report, settings.folder);
  std::fputs(bench::throughput_text(report).c_str(), stdout);
  spdlog::info("bench: report.json, report.md and plots are in {}", settings.folder.string());
  return 0;
}

}  // namespace goldthread
