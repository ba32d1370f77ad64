// SPDX-License-Identifier: Apache-2.0
// goldthread: the entry. Parses the command line, runs the command, and turns whatever went wrong
// into one line and the documented exit status.

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "common/transport/mpi_transport.h"
#include "master/main/program.h"

namespace {

using namespace goldthread;

std::optional<std::string> environment(const std::string& name) {
  const char* value = std::getenv(name.c_str());
  if (value == nullptr) return {};
  return value;
}

/// Of the processes of an MPI job the first speaks for all about what all of them see.
bool speaks() {
  for (const char* variable : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK"}) {
    if (const auto rank = environment(variable)) return *rank == "0";
  }
  return true;
}

int fail(const Failure& failure) {
  std::fprintf(stderr, "%s\n", failure.line().c_str());
  return static_cast<int>(failure.status);
}

void set_up_log(LogLevel level) {
  auto logger = spdlog::stderr_color_mt("goldthread");
  logger->set_pattern("goldthread: %v");
  constexpr spdlog::level::level_enum levels[] = {spdlog::level::err, spdlog::level::warn,
                                                  spdlog::level::info, spdlog::level::debug};
  logger->set_level(levels[static_cast<int>(level)]);
  spdlog::set_default_logger(std::move(logger));
}

int run(const Options& options) {
  set_up_log(options.log_level);
  switch (options.command) {
    case Command::kInfo:
      return run_info(options);
    case Command::kBench:
      if (options.bench.subject == "scale" && ranks_of_mpi_job() > 1)
        return time_mpi_messages(options);
      return speaks() ? run_bench(options) : 0;
    case Command::kRender:
    case Command::kServe:
      return run_cluster(options);
  }
  return static_cast<int>(ExitStatus::kUsage);
}

}  // namespace

int main(int argc, char** argv) {
  const auto parsed = parse_command_line({argv + 1, argv + argc}, environment);
  // A silent process must not end with a status: mpirun would end the first before it has spoken.
  if (!speaks() && (!parsed || std::holds_alternative<TextOutcome>(*parsed))) return 0;
  if (!parsed) return fail(parsed.failure());
  if (const auto* text = std::get_if<TextOutcome>(&*parsed)) {
    std::fputs(text->text.c_str(), stdout);
    return 0;
  }
  try {
    return run(std::get<Options>(*parsed));
  } catch (const FatalError& error) {
    return fail(error.failure());
  } catch (const std::exception& error) {
    return fail({"goldthread", error.what(), "please report this", ExitStatus::kClusterFailed});
  }
}
