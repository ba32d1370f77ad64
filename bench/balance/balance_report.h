// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the bench of load balance has found: tables, goals, JSON and plots. Pure.

#include <string>
#include <vector>

#include "bench/error/plots.h"
#include "bench/error/report.h"

namespace goldthread::bench {

/// Frames a second of one method at each distance: VOL2's Figure 9.
struct RateRow {
  std::string method;
  int workers = 0;
  bool replayed = false;  ///< else on this machine
  std::vector<double> frames_per_second;
};

/// What descending cost gains over screen order: times of frames, less 1, at all distances.
struct GainRow {
  std::size_t tiles = 0;
  int workers = 0;
  double least = 0;
  double median = 0;
  double most = 0;
};

/// Of four workers, max / mean − 1 of processor time: medians.
struct ImbalanceRow {
  std::string what;
  double measured = 0;
  double replayed = 0;
};

/// Σ|predicted − actual| / Σ actual over tiles: medians of a path's frames.
struct PredictionRow {
  std::string path;
  double as_it_was = 0;
  double reprojected = 0;
};

struct BalanceReport {
  std::string version;
  std::string date;  ///< UTC, ISO 8601
  Machine machine;
  std::string scene;
  ImageSize size;
  bool quick = false;
  int repeats = 1;
  std::vector<double> distances;  ///< in the scene's own
  std::vector<RateRow> rates;
  std::vector<GainRow> gains;
  std::vector<ImbalanceRow> imbalances;
  std::vector<PredictionRow> predictions;
  std::vector<std::string> notes;
};

/// The imbalance is to be this at most, and the gain this at least, with this many tiles for each
/// worker.
constexpr double kGoalImbalance = 0.03;
constexpr double kGoalGain = 0.10;
constexpr std::size_t kGoalTilesPerWorker = 8;

std::vector<Goal> balance_goals(const BalanceReport& report);
std::vector<Section> balance_sections(const BalanceReport& report);
std::string balance_text(const BalanceReport& report);
std::string balance_markdown(const BalanceReport& report);
std::string balance_json(const BalanceReport& report);
/// "figure-9-measured", and "figure-9-N-workers" for each number of workers that was replayed.
std::vector<Plot> balance_plots(const BalanceReport& report);

}  // namespace goldthread::bench
