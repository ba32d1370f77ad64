// SPDX-License-Identifier: Apache-2.0
// `goldthread bench balance`.

#include <spdlog/spdlog.h>

#include <cstdio>

#include "bench/balance/bench_balance.h"
#include "master/main/bench_setup.h"
#include "master/main/program.h"

namespace goldthread {
namespace {

constexpr int kRepeats = 9;
constexpr int kQuickRepeats = 3;

}  // namespace

int run_balance_bench(const Options& options) {
  const std::filesystem::path folder = report_folder(options.output);
  bench::BalanceBenchSettings settings;
  settings.scene_name = scene_name(options);
  settings.quick = options.bench.quick;
  settings.repeats = options.bench.repeats.value_or(settings.quick ? kQuickRepeats : kRepeats);
  Phases phases;
  settings.progress = [&](const std::string& what, double fraction) {
    phases.update(what, fraction);
  };

  bench::BalanceReport report = bench::run_balance_bench(subject_of(options), settings);
  phases.end();
  bench::write_balance_report(report, folder);
  std::fputs(bench::balance_text(report).c_str(), stdout);
  spdlog::info("bench: report.json, report.md and plots are in {}", folder.string());
  return 0;
}

}  // namespace goldthread
