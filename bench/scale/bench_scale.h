// SPDX-License-Identifier: Apache-2.0
#pragma once
// `goldthread bench scale`: how far one master reaches, simulated. Costs of rays, messages and
// roles are measured on this machine, then the project's own scheduler deals pictures of 1 to 64
// Mpixel to up to 4096 workers that do not exist.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "bench/error/subject.h"
#include "bench/scale/scale_report.h"

namespace goldthread::bench {

struct ScaleBenchSettings {
  std::string scene_name;  ///< how the report calls the scene
  int threads = 1;
  bool quick = false;  ///< smaller recordings, fewer workers and frames
  /// Messages between processes, or why there are none.
  std::function<Result<MeasuredLink>()> time_mpi;
  std::function<void(const std::string& what, double fraction)> progress = [](const std::string&,
                                                                              double) {};
};

/// Takes a minute, or a quarter of one if quick.
ScaleReport run_scale_bench(const Subject& subject, const ScaleBenchSettings& settings);

/// Writes report.json, report.md and the plots; what could not be drawn is added to the notes.
/// Throws FatalError where the folder cannot be written.
void write_scale_report(ScaleReport& report, const std::filesystem::path& folder);

}  // namespace goldthread::bench
