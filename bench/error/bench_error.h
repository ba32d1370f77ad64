// SPDX-License-Identifier: Apache-2.0
#pragma once
// `goldthread bench error`: speed against error of every method, beside other renderers, on one
// scene. Renders with the ray caster itself; knows no role and no transport.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "bench/error/report.h"
#include "bench/error/subject.h"

namespace goldthread::bench {

struct ErrorBenchSettings {
  std::filesystem::path folder;   ///< for the report, exists
  std::filesystem::path program;  ///< goldthread itself, started anew for the time to a picture
  std::string scene_name;         ///< how the report calls the scene
  int threads = 1;
  int repeats = 9;  ///< frames of each method
  int stride = 4;   ///< the reference takes every stride-th pixel in both directions
  bool quick = false;
  bool peers = true;
  bool all_instruction_sets = false;  ///< besides the best one
  /// Told what is being done, and how much of it is (0 … 1).
  std::function<void(const std::string& what, double fraction)> progress = [](const std::string&,
                                                                              double) {};
};

/// The settings' progress for one thing that is done.
std::function<void(double)> in_phase(const ErrorBenchSettings& settings, std::string what);

/// Takes minutes, or seconds if quick. A peer that is missing or fails is named in the report.
Report run_error_bench(const Subject& subject, const ErrorBenchSettings& settings);

/// Writes report.json, report.md and the plots; what could not be drawn is added to the notes.
/// Throws FatalError where the folder cannot be written.
void write_report(Report& report, const std::filesystem::path& folder);

}  // namespace goldthread::bench
