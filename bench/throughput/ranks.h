// SPDX-License-Identifier: Apache-2.0
#pragma once
// Clusters that the bench starts: this program again, as ranks under mpirun or as one process, with
// chosen roles by-passed. What they measure comes back in files.

#include <filesystem>
#include <string>
#include <vector>

#include "bench/throughput/frames.h"
#include "bench/throughput/stream.h"

namespace goldthread::bench {

/// What carries messages.
enum class Carrier : std::uint8_t { kSharedMemory, kTcp, kThreads };
/// "MPI, shared memory", "MPI, TCP", "one process".
const char* name_of(Carrier carrier);
constexpr bool is_mpi(Carrier carrier) { return carrier != Carrier::kThreads; }

struct RanksSetup {
  Carrier carrier = Carrier::kSharedMemory;
  ImageSize size;
  int tile_px = 64;
  int workers = 1;
  std::string bypass;
};

/// `mpirun` with its options for one machine, or `program` itself, then `bench SUBJECT` with all
/// that the setup says.
std::vector<std::string> command_of(const RanksSetup& setup, const std::string& subject,
                                    const std::filesystem::path& program,
                                    const std::filesystem::path& folder, const std::string& scene,
                                    bool quick);

class RanksStarter {
 public:
  struct Settings {
    std::filesystem::path program;
    std::filesystem::path folder;  ///< for their files
    std::string scene;             ///< empty: the default head
    bool quick = false;
  };
  explicit RanksStarter(Settings settings);

  /// Throw PeerFailure where the ranks could not be started or failed.
  FramesResult frames(const RanksSetup& setup) const;
  StreamResult stream(const RanksSetup& setup) const;

 private:
  std::string run(const RanksSetup& setup, const std::string& subject,
                  const std::string& result) const;

  Settings settings_;
};

}  // namespace goldthread::bench
