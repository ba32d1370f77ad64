// SPDX-License-Identifier: Apache-2.0
#pragma once
// `goldthread bench motion`: what is displayed while the camera moves, method beside method,
// against a renderer without latency. Renders with the ray caster itself; knows no role and no
// transport, of the master and the compositors only what is pure. Time is virtual
// (motion_method.h).

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "bench/error/subject.h"
#include "bench/motion/motion_report.h"

namespace goldthread::bench {

struct MotionBenchSettings {
  std::string scene_name;  ///< how the report calls the scene
  int threads = 1;
  bool quick = false;  ///< a second of each path
  /// All costs are multiplied so that a full frame takes this long; nothing: as they are.
  std::optional<double> full_frame_seconds;
  std::function<void(const std::string& what, double fraction)> progress = [](const std::string&,
                                                                              double) {};
};

/// Takes minutes, or half of one if quick.
MotionReport run_motion_bench(const Subject& subject, const MotionBenchSettings& settings);

/// Writes report.json and the plots; what could not be drawn is added to the notes. Throws
/// FatalError where the folder cannot be written.
void write_motion_report(MotionReport& report, const std::filesystem::path& folder);

}  // namespace goldthread::bench
