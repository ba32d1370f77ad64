// SPDX-License-Identifier: Apache-2.0
// `goldthread bench error`.

#include <spdlog/spdlog.h>

#include <cstdio>

#include "bench/error/bench_error.h"
#include "bench/interrupts/interrupts.h"
#include "master/main/bench_setup.h"
#include "master/main/program.h"

namespace goldthread {
namespace {

constexpr int kInterrupts = 500;
constexpr int kQuickInterrupts = 50;

}  // namespace

int run_error_bench(const Options& options) {
  bench::ErrorBenchSettings settings;
  settings.folder = report_folder(options.output);
  settings.program = std::filesystem::read_symlink("/proc/self/exe");
  settings.scene_name = scene_name(options);
  settings.threads = threads_of(options);
  settings.quick = options.bench.quick;
  settings.repeats = options.bench.repeats.value_or(settings.quick ? 3 : 9);
  settings.stride = options.bench.stride.value_or(settings.quick ? 16 : 4);
  settings.peers = options.bench.peers;
  settings.all_instruction_sets = options.bench.all_instruction_sets;
  Phases phases;
  settings.progress = [&](const std::string& what, double fraction) {
    phases.update(what, fraction);
  };

  const bench::Subject subject = subject_of(options);
  bench::Report report = bench::run_error_bench(subject, settings);
  report.interrupts =
      bench::measure_interrupts(subject, settings.quick ? kQuickInterrupts : kInterrupts, settings);
  phases.end();
  bench::write_report(report, settings.folder);
  std::fputs(bench::report_text(report).c_str(), stdout);
  spdlog::info("bench: report.json, report.md and plots are in {}", settings.folder.string());
  return 0;
}

}  // namespace goldthread
