// SPDX-License-Identifier: Apache-2.0
#pragma once
// `goldthread bench throughput`: VOL2's three figures of a renderer whose roles are by-passed, and
// what a compositor's work takes part by part (State et al. 1995, "Interactive volume visualization
// on a heterogeneous message-passing multicomputer"). Starts clusters of its own (ranks.h).

#include <filesystem>
#include <functional>
#include <string>

#include "bench/error/subject.h"
#include "bench/throughput/throughput_report.h"

namespace goldthread::bench {

struct ThroughputBenchSettings {
  std::filesystem::path program;
  std::filesystem::path folder;
  std::string scene;       ///< file; empty: the default head
  std::string scene_name;  ///< how the report calls it
  bool quick = false;      ///< fewer sizes and workers, shorter
  std::function<void(const std::string& what, double fraction)> progress = [](const std::string&,
                                                                              double) {};
};

/// Takes two minutes, or a quarter of that if quick. Where ranks cannot be started, a note says so.
ThroughputReport run_throughput_bench(const Subject& subject,
                                      const ThroughputBenchSettings& settings);

/// Writes report.json, report.md and the plots; what could not be drawn is added to the notes.
/// Throws FatalError where the folder cannot be written.
void write_throughput_report(ThroughputReport& report, const std::filesystem::path& folder);

}  // namespace goldthread::bench
