// SPDX-License-Identifier: Apache-2.0
#include "bench/throughput/ranks.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "bench/error/process.h"

namespace goldthread::bench {
namespace {

constexpr std::chrono::seconds kPatience{120};

/// As launch/run has it: any user may start it anywhere, and it is silent.
std::vector<std::string> mpirun(Carrier carrier, int ranks) {
  const char* const btl = carrier == Carrier::kTcp ? "self,tcp" : "self,vader";
  return {"env",
          "OMPI_ALLOW_RUN_AS_ROOT=1",
          "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1",
          "OMPI_MCA_pml=ob1",
          std::string("OMPI_MCA_btl=") + btl,
          "OMPI_MCA_btl_tcp_if_include=lo",
          "OMPI_MCA_btl_vader_single_copy_mechanism=none",
          "HWLOC_HIDE_ERRORS=2",
          "mpirun",
          "--oversubscribe",
          "--bind-to",
          "none",
          "-n",
          std::to_string(ranks)};
}

template <class Value>
Value value_or_fail(Result<Value> result) {
  if (!result) throw PeerFailure(result.failure().line());
  return std::move(*result);
}

}  // namespace

const char* name_of(Carrier carrier) {
  switch (carrier) {
    case Carrier::kSharedMemory:
      return "MPI, shared memory";
    case Carrier::kTcp:
      return "MPI, TCP";
    case Carrier::kThreads:
      return "one process";
  }
  return "";
}

std::vector<std::string> command_of(const RanksSetup& setup, const std::string& subject,
                                    const std::filesystem::path& program,
                                    const std::filesystem::path& folder, const std::string& scene,
                                    bool quick) {
  std::vector<std::string> words;
  if (is_mpi(setup.carrier)) words = mpirun(setup.carrier, 2 + setup.workers);
  words.insert(words.end(), {program.string(), "bench", subject});
  if (!scene.empty()) words.push_back(scene);
  const auto add = [&](const char* option, const std::string& value) {
    words.insert(words.end(), {option, value});
  };
  add("--size", fmt::format("{}x{}", setup.size.width, setup.size.height));
  add("--tile", std::to_string(setup.tile_px));
  add("--compositors", "1");
  add("--threads", "1");
  add("--bypass", setup.bypass.empty() ? "none" : setup.bypass);
  add("--log-level", "error");
  add("-o", folder.string());
  if (!is_mpi(setup.carrier)) add("--workers", std::to_string(setup.workers));
  if (quick) words.emplace_back("--quick");
  return words;
}

RanksStarter::RanksStarter(Settings settings) : settings_(std::move(settings)) {
  std::error_code error;
  std::filesystem::create_directories(settings_.folder, error);
}

std::string RanksStarter::run(const RanksSetup& setup, const std::string& subject,
                              const std::string& result) const {
  const auto file = settings_.folder / result;
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  ChildProcess ranks(command_of(setup, subject, settings_.program, settings_.folder,
                                settings_.scene, settings_.quick),
                     settings_.folder / "ranks.log");
  ranks.wait(kPatience);
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

FramesResult RanksStarter::frames(const RanksSetup& setup) const {
  return value_or_fail(parse_frames(run(setup, "frames", kFramesFile), kFramesFile));
}

StreamResult RanksStarter::stream(const RanksSetup& setup) const {
  return value_or_fail(parse_stream(run(setup, "stream", kStreamFile), kStreamFile));
}

}  // namespace goldthread::bench
