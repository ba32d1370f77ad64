// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the bench of motion has found: as a table, as JSON, and as plots. Pure.

#include <string>
#include <vector>

#include "bench/error/plots.h"
#include "bench/error/report.h"
#include "bench/error/table.h"
#include "bench/motion/playback.h"

namespace goldthread::bench {

struct MotionRow {
  std::string path;
  std::string method;
  Showing showing;
};

struct MotionReport {
  std::string version;
  std::string date;  ///< UTC, ISO 8601
  Machine machine;
  std::string kernel;
  std::string scene;
  ImageSize size;
  int threads = 1;
  double full_frame_seconds = 0;                           ///< median, as it was measured
  double cost_factor = 1;                                  ///< what all costs were multiplied by
  std::vector<std::pair<std::string, std::string>> paths;  ///< name, and what it is
  std::vector<MotionRow> rows;
  std::vector<std::string> notes;
};

/// A row for each path and method: mean and 95th percentile of the RMS error, pictures a second,
/// mean latency.
Table motion_table(const MotionReport& report);
/// For each path the method with the least mean error, and how much more the interruptible one has:
/// "slow orbit: the least is 0.950, a quarter of the pixels; interruptible 1.18 (1.24 times)".
std::vector<std::string> motion_findings(const MotionReport& report);
/// Both with what they are of, for a terminal and in Markdown.
std::string motion_text(const MotionReport& report);
std::string motion_markdown(const MotionReport& report);
std::string motion_json(const MotionReport& report);
/// For each path the error over time, a curve for each method: "slow-orbit".
std::vector<Plot> motion_plots(const MotionReport& report);

}  // namespace goldthread::bench
