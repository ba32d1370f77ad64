// SPDX-License-Identifier: Apache-2.0
// `goldthread bench`: measurements of this machine, to a folder and to stdout.

#include <spdlog/spdlog.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "bench/error/bench_error.h"
#include "bench/interrupts/interrupts.h"
#include "bench/motion/bench_motion.h"
#include "common/base/cores.h"
#include "common/image/whole_file.h"
#include "common/scene/scene_file.h"
#include "master/main/program.h"
#include "master/main/progress.h"

namespace goldthread {
namespace {

constexpr int kInterrupts = 500;
constexpr int kQuickInterrupts = 50;

/// The folder, made where it is missing; whether it takes a report is found before the work.
std::filesystem::path report_folder(const std::string& name) {
  std::filesystem::path folder = std::filesystem::absolute(name);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw FatalError({name, "cannot be made: " + error.message(), "choose another folder with -o",
                      ExitStatus::kClusterFailed});
  }
  expect_writable(folder / "report.json");
  return folder;
}

/// The default head in motion: as large as a full frame can follow.
constexpr ImageSize kMotionSize{256, 256};

bool is_motion(const Options& options) { return options.bench.subject == "motion"; }

std::string scene_name(const Options& options) {
  return options.input.empty() ? "default head" : options.input;
}

int threads_of(const Options& options) {
  return options.threads.value_or(static_cast<int>(usable_cores()));
}

bench::Subject subject_of(const Options& options) {
  const bool is_default = options.input.empty();
  Scene scene = is_default ? bench::default_scene() : value_or_throw(read_scene(options.input));
  if (is_default && is_motion(options)) scene.image.size = kMotionSize;
  if (options.size) scene.image.size = *options.size;
  return value_or_throw(bench::load_subject(std::move(scene), is_default));
}

/// A bar, or lines, for each thing that is done.
class Phases {
 public:
  void update(const std::string& what, double fraction) {
    if (what != what_) progress_ = std::make_unique<Progress>(what);
    what_ = what;
    progress_->update(fraction);
  }
  void end() { progress_.reset(); }

 private:
  std::string what_;
  std::unique_ptr<Progress> progress_;
};

int run_error(const Options& options) {
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

int run_motion(const Options& options) {
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

  bench::MotionReport report = bench::run_motion_bench(subject_of(options), settings);
  phases.end();
  bench::write_motion_report(report, folder);
  std::fputs(bench::motion_text(report).c_str(), stdout);
  spdlog::info("bench: report.json and plots are in {}", folder.string());
  return 0;
}

}  // namespace

int run_bench(const Options& options) {
  return is_motion(options) ? run_motion(options) : run_error(options);
}

}  // namespace goldthread
