// SPDX-License-Identifier: Apache-2.0
#pragma once
// `goldthread bench balance`: Figure 9 of VOL2 (State, McAllister, Neumann, Chen, Cullip, Chen &
// Fuchs 1995, "Interactive volume visualization on a heterogeneous message-passing multicomputer"):
// the frame rate against the distance of the camera, for several ways to hand a picture out; how
// even the work is; how well the last frame foretells the next. Frames are cast by real roles in
// threads of this process, a ray in each pixel's centre, as a session in motion does.

#include <filesystem>
#include <functional>
#include <string>

#include "bench/balance/balance_report.h"
#include "bench/error/subject.h"

namespace goldthread::bench {

struct BalanceBenchSettings {
  std::string scene_name;  ///< how the report calls the scene
  int repeats = 9;         ///< frames of each method and distance
  bool quick = false;      ///< fewer distances
  std::function<void(const std::string& what, double fraction)> progress = [](const std::string&,
                                                                              double) {};
};

/// Takes a minute or two. Throws FatalError.
BalanceReport run_balance_bench(const Subject& subject, const BalanceBenchSettings& settings);

/// Writes report.json, report.md and the plots; what could not be drawn is added to the notes.
/// Throws FatalError where the folder cannot be written.
void write_balance_report(BalanceReport& report, const std::filesystem::path& folder);

}  // namespace goldthread::bench
