// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the bench of scale has measured and simulated: as tables, as JSON, and as plots. Pure.

#include <string>
#include <vector>

#include "bench/error/plots.h"
#include "bench/error/report.h"
#include "bench/error/table.h"
#include "bench/scale/linear_fit.h"
#include "bench/scale/message_times.h"
#include "bench/scale/role_costs.h"
#include "bench/scale/sweep.h"
#include "bench/scale/validation.h"

namespace goldthread::bench {

/// The efficiency that a second level is to have.
constexpr double kGoal = 0.8;

struct ScaleReport {
  std::string version;
  std::string date;  ///< UTC, ISO 8601
  Machine machine;
  std::string kernel;
  std::string scene;
  ImageSize recorded_size;
  std::vector<std::string> views;              ///< "whole head, refined to 0.5"
  std::vector<std::vector<LinearFit>> prices;  ///< of their steps: a ray, a field evaluation
  std::vector<double> thread_seconds;          ///< of each, as recorded
  std::vector<MeasuredLink> links;             ///< the simulation uses the last one
  ClusterModel model;
  double placing_residual = 0;
  std::vector<ValidationRow> validation;
  std::vector<SweepPoint> one_level;
  std::vector<SweepPoint> two_levels;         ///< with 4096 workers
  std::vector<SweepPoint> with_second_level;  ///< of the first view
  std::vector<std::string> notes;
};

/// "12.3 µs, and 0.4 ns a byte".
Table link_table(const ScaleReport& report);
Table master_table(const ScaleReport& report);
Table validation_table(const ScaleReport& report);
/// A row for each number of workers, a column for each size; of one view.
Table efficiency_table(const ScaleReport& report, int view);
/// For each view and size: how many workers one master can keep busy, where efficiency falls below
/// a half, and why.
Table saturation_table(const ScaleReport& report);
/// For each view and size the second level of masters for 4096 workers.
Table second_level_table(const ScaleReport& report);

std::string scale_text(const ScaleReport& report);
std::string scale_markdown(const ScaleReport& report);
std::string scale_json(const ScaleReport& report);

/// Efficiency against workers: with one master, a plot for each way of casting the first scene's
/// view, and with one and two levels of masters.
std::vector<Plot> scale_plots(const ScaleReport& report);

}  // namespace goldthread::bench
