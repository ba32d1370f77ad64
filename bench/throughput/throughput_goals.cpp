// SPDX-License-Identifier: Apache-2.0
// The project's figures of throughput, beside what was measured.

#include <fmt/format.h>

#include <algorithm>

#include "bench/error/goals.h"
#include "bench/throughput/throughput_report.h"

namespace goldthread::bench {
namespace {

constexpr double kShare = 0.7;
constexpr int kShareFrom = 1024;  ///< pixels a side
constexpr double kTilesPerSecond = 50'000;
constexpr double kPercentOfCore = 2;
constexpr int kPacedWorkers = 8;
constexpr double kBackEndMs = 10;

Goal at_least(std::string what, double wanted, std::optional<double> reached) {
  return {std::move(what), fmt::format("≥ {:g}", wanted),
          reached ? number(*reached) : "not measured",
          reached ? std::optional(*reached >= wanted) : std::nullopt};
}

void add_share(const ThroughputReport& report, Carrier carrier, std::vector<Goal>& goals) {
  std::optional<double> least;
  for (const FramesRow& row : report.bypassed) {
    const auto share = row.share_of_stream();
    if (row.setup.carrier != carrier || row.setup.size.width < kShareFrom || !share) continue;
    least = std::min(least.value_or(*share), *share);
  }
  goals.push_back(
      at_least(fmt::format("sample bytes per second of those of MPI alone, {}×{} and above, {}",
                           kShareFrom, kShareFrom, name_of(carrier)),
               kShare, least));
}

void add_master(const ThroughputReport& report, std::vector<Goal>& goals) {
  std::optional<double> tiles, alone, core;
  for (const FramesRow& row : report.master) {
    tiles = std::max(tiles.value_or(0), row.tiles_per_second());
    alone = std::max(alone.value_or(0), row.frames.tiles_per_master_second());
    const PacedFrames& paced = row.frames.paced;
    if (row.setup.carrier != Carrier::kSharedMemory || row.setup.workers != kPacedWorkers ||
        paced.seconds <= 0)
      continue;
    core = std::max(core.value_or(0), 100 * paced.master_cpu_seconds / paced.seconds);
  }
  goals.push_back(at_least("tiles per second that the master schedules", kTilesPerSecond, tiles));
  goals.push_back(at_least("the same per second of its processor time", kTilesPerSecond, alone));
  goals.push_back(at_most(fmt::format("percent of a core that the master takes at 60 frames a "
                                      "second, {} workers, shared memory",
                                      kPacedWorkers),
                          kPercentOfCore, core));
}

void add_back_end(const ThroughputReport& report, std::vector<Goal>& goals) {
  for (const BackEndRow& row : report.parts) {
    const std::string what =
        fmt::format("ms from samples to bytes, {}×{}, {}, ", report.back_end_size.width,
                    report.back_end_size.height, row.samples);
    goals.push_back(at_most(what + "JPEG", kBackEndMs, 1e3 * row.all_jpeg.median));
    goals.push_back(at_most(what + "zstd", kBackEndMs, 1e3 * row.all_zstd.median));
  }
}

}  // namespace

std::vector<Goal> throughput_goals(const ThroughputReport& report) {
  std::vector<Goal> goals;
  add_share(report, Carrier::kSharedMemory, goals);
  add_share(report, Carrier::kTcp, goals);
  add_master(report, goals);
  add_back_end(report, goals);
  return goals;
}

}  // namespace goldthread::bench
