// SPDX-License-Identifier: Apache-2.0
// `goldthread bench scale`; and, as two ranks of an MPI job, what messages cost between them.

#include <spdlog/spdlog.h>

#include <cstdio>

#include "bench/error/draw.h"
#include "bench/error/process.h"
#include "bench/scale/bench_scale.h"
#include "bench/scale/message_file.h"
#include "common/scene/text_file.h"
#include "common/transport/mpi_transport.h"
#include "master/main/bench_setup.h"
#include "master/main/program.h"

namespace goldthread {
namespace {

constexpr const char* kMessages = "messages.json";
constexpr std::size_t kMostMessagesBytes = 1 << 20;
constexpr std::chrono::seconds kMpiPatience{60};

Result<bench::MeasuredLink> link_of(const std::filesystem::path& file) {
  const auto text = read_text_file(file, kMostMessagesBytes);
  if (!text) return text.failure();
  return bench::read_link(*text, file.string());
}

/// Between two processes of this machine, started for it; or what another job has measured.
Result<bench::MeasuredLink> time_mpi(const std::filesystem::path& folder, bool quick) {
  if (std::filesystem::exists(folder / kMessages)) return link_of(folder / kMessages);
  const std::filesystem::path own = folder / "mpi";
  std::vector<std::string> command{"env",
                                   "OMPI_ALLOW_RUN_AS_ROOT=1",
                                   "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1",
                                   "mpirun",
                                   "--oversubscribe",
                                   "--bind-to",
                                   "none",
                                   "-n",
                                   "2",
                                   std::filesystem::read_symlink("/proc/self/exe").string(),
                                   "bench",
                                   "messages",
                                   "-o",
                                   own.string()};
  if (quick) command.emplace_back("--quick");
  try {
    std::filesystem::remove(own / kMessages);
    bench::ChildProcess job(command, folder / "mpirun.log");
    job.wait(kMpiPatience);
  } catch (const bench::PeerFailure& failure) {
    return Failure{"mpirun", failure.what(), "messages between threads are taken instead",
                   ExitStatus::kClusterFailed};
  }
  return link_of(own / kMessages);
}

}  // namespace

int run_messages_bench(const Options& options) {
  MpiTransport transport;
  constexpr Rank kAsking{0}, kAnswering{1};
  if (transport.rank() == kAnswering) bench::answer_messages(transport);
  if (transport.rank() != kAsking) return 0;
  const std::filesystem::path folder = report_folder(options.output);
  const bench::MeasuredLink link{"MPI",
                                 bench::time_messages(transport, kAnswering, options.bench.quick)};
  bench::write_text(folder / kMessages, bench::link_json(link));
  return 0;
}

int run_scale_bench(const Options& options) {
  const std::filesystem::path folder = report_folder(options.output);
  bench::ScaleBenchSettings settings;
  settings.scene_name = scene_name(options);
  settings.threads = threads_of(options);
  settings.quick = options.bench.quick;
  settings.time_mpi = [&] { return time_mpi(folder, settings.quick); };
  Phases phases;
  settings.progress = [&](const std::string& what, double fraction) {
    phases.update(what, fraction);
  };

  bench::ScaleReport report = bench::run_scale_bench(subject_of(options), settings);
  phases.end();
  bench::write_scale_report(report, folder);
  std::fputs(bench::scale_text(report).c_str(), stdout);
  spdlog::info("bench: report.json, report.md and plots are in {}", folder.string());
  return 0;
}

}  // namespace goldthread
