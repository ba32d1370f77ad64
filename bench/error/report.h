// SPDX-License-Identifier: Apache-2.0
#pragma once
// What `goldthread bench error` has found, as data, and its forms: JSON for programs, tables for a
// terminal and for the documentation. Pure.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/error/adaptive_report.h"
#include "bench/error/statistics.h"
#include "bench/error/subject.h"
#include "bench/error/table.h"

namespace goldthread::bench {

struct Machine {
  std::string processor;
  int cores = 1;  ///< that this process may use
  std::string system;
};

/// One program, look and step.
struct MethodRow {
  std::string program;  ///< "Goldthread", "VTK", "ParaView"
  Look look = Look::kUnlit;
  std::string how;              ///< kernel or mapper
  std::string instruction_set;  ///< of Goldthread's
  double step_voxels = 0;       ///< 0: the program's default
  Seconds seconds;
  std::uint64_t rays = 0;
  std::uint64_t samples = 0;  ///< 0: unknown
  PictureError error;
  std::optional<Shift> shift;  ///< a peer's best alignment
  double samples_per_second() const;
};

/// The integrator against itself: what halving and doubling its substeps changes, by RMS.
struct ReferenceRow {
  Look look = Look::kUnlit;
  int substeps = 0;
  double halved = 0;
  double doubled = 0;
  double smallest_error = 0;  ///< of what was measured against it
  double seconds = 0;
  /// Whether its own error, by the change on doubling, is a tenth of the smallest at most.
  bool is_converged() const { return doubled <= 0.1 * smallest_error; }
};

/// Some scene's frame time over another's, frame by frame in turn.
struct RatioRow {
  std::string name;
  std::string base;
  std::string kernel;
  Seconds seconds;
  double by_rounds = 1;   ///< the median of the rounds' ratios
  double by_minimum = 1;  ///< of the quickest frames
  bool off = false;       ///< has no effect on the picture
};

struct PeerRow {
  std::string name;
  std::string version;
  std::string failure;  ///< why something of it is missing; empty if nothing is
};

/// Programs that turn a changed scene, or nothing at all, into a picture.
struct LatencyRow {
  std::string what;  ///< "new isovalue", "start", "frame beside ParaView's"
  std::string program;
  Seconds seconds;
};

/// From a new view until the last worker has begun it.
struct InterruptRow {
  Look look = Look::kUnlit;
  ImageSize size;
  int count = 0;
  double median = 0;  ///< seconds
  double percentile_99 = 0;
  double batch_median = 0;  ///< of the rays that a worker casts between two looks
  double batch_percentile_99 = 0;
};

struct GatherRow {
  std::string instruction_set;
  Seconds seconds;  ///< of `samples`
  std::uint64_t samples = 0;
  double samples_per_second() const {
    return seconds.median > 0 ? double(samples) / seconds.median : 0;
  }
};

struct MemoryFigures {
  std::uint64_t voxel_bytes = 0;
  std::uint64_t block_bytes = 0;   ///< voxels as they lie, their cells and padding
  std::uint64_t commit_bytes = 0;  ///< what committing the lit scene allocates
  double beyond() const;           ///< as a share of the voxels
};

struct Report {
  std::string version;
  std::string date;  ///< UTC, ISO 8601
  Machine machine;
  std::string instruction_set;
  std::string scene;  ///< file, or "default head"
  std::string volume;
  bool default_scene = false;
  ImageSize size;
  int threads = 1;
  int repeats = 1;
  int stride = 1;
  bool quick = false;
  double voxel_mm = 1;
  double isovalue = 0;
  double next_isovalue = 0;
  std::vector<ReferenceRow> references;
  std::vector<MethodRow> methods;
  std::vector<LatencyRow> latencies;
  std::vector<RatioRow> storages;
  std::vector<RatioRow> features;
  std::vector<GatherRow> gathers;
  MemoryFigures memory;
  AdaptiveReport adaptive;
  std::vector<InterruptRow> interrupts;
  std::vector<PeerRow> peers;
  std::vector<std::string> notes;

  /// `on`: the instruction set; empty for peers.
  const MethodRow* find(const std::string& program, Look look, double step_voxels,
                        const std::string& on) const;
  const LatencyRow* find_latency(const std::string& what, const std::string& program) const;
};

/// A figure that the project has set itself, and what came out.
struct Goal {
  std::string what;
  std::string goal;
  std::string reached;
  std::optional<bool> met;  ///< nothing: could not be measured
};
std::vector<Goal> goals_of(const Report& report);

std::string report_json(const Report& report);

/// A part of the report for people.
struct Section {
  std::string title;
  std::string note;
  Table table;
};
std::vector<Section> sections_of(const Report& report);
/// Sections one after the other.
std::string report_text(const Report& report);
std::string report_markdown(const Report& report);

}  // namespace goldthread::bench
