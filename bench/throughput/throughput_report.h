// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the bench of throughput has found: as tables, goals, JSON and plots. Pure.

#include <optional>
#include <string>
#include <vector>

#include "bench/error/plots.h"
#include "bench/error/report.h"
#include "bench/throughput/back_end.h"
#include "bench/throughput/ranks.h"

namespace goldthread::bench {

struct FramesRow {
  RanksSetup setup;
  FramesResult frames;
  std::optional<StreamResult> stream;  ///< MPI alone, before and after
  std::vector<double> shares;          ///< of all rounds, ascending: this is the middle one

  double frames_per_second() const;
  double lossless_per_second() const;
  double tiles_per_second() const;
  double sample_bytes_per_second() const;
  /// Of what MPI alone carries; nothing where that was not measured.
  std::optional<double> share_of_stream() const;
};

/// The one of these rounds, at least one, whose share is the middle one.
FramesRow middle_of(std::vector<FramesRow> rounds);

struct ThroughputReport {
  std::string version;
  std::string date;  ///< UTC, ISO 8601
  Machine machine;
  std::string scene;
  ImageSize back_end_size;
  std::vector<FramesRow> bypassed;  ///< all roles are (figure 4)
  std::vector<FramesRow> master;    ///< all but the master (figure 5)
  std::vector<FramesRow> back_end;  ///< all but the compositor (figure 6)
  std::vector<BackEndRow> parts;
  std::vector<std::string> notes;
};

/// Goals first, then the three figures and the parts of the back end.
std::vector<Section> throughput_sections(const ThroughputReport& report);
std::vector<Goal> throughput_goals(const ThroughputReport& report);
std::string throughput_text(const ThroughputReport& report);
std::string throughput_markdown(const ThroughputReport& report);
std::string throughput_json(const ThroughputReport& report);
/// "everything-bypassed", "master-alone", "back-end-alone".
std::vector<Plot> throughput_plots(const ThroughputReport& report);

}  // namespace goldthread::bench
