// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the bench measures of the project's own: every look and step, kinds of voxel, features, the
// bare loop, memory.

#include <vector>

#include "bench/error/bench_error.h"
#include "bench/error/references.h"
#include "bench/error/rounds.h"

namespace goldthread::bench {

/// Steps in voxels; 0 is the default.
std::vector<double> own_steps(bool quick);

/// One look and step of ours.
struct OwnEntry {
  Look look;
  double step_voxels;
  OwnMethod method;
};
std::vector<OwnEntry> own_entries(const Subject& subject, const std::vector<double>& steps);

/// Rows of contestants that render `entries` in this order, with errors from a further frame.
std::vector<MethodRow> own_rows(std::vector<OwnEntry>& entries,
                                const std::vector<Contestant>& contestants, FrameCaster& caster,
                                References& references, const ErrorBenchSettings& settings);

/// The bare loop as a contestant, as many samples in a frame as take it tens of milliseconds.
Contestant gather_contestant(const Subject& subject, int threads);
GatherRow gather_row(const Contestant& contestant, int threads);

/// Looks at their default step on an instruction set that is not the best.
void measure_instruction_set(const std::string& name, const Subject& subject,
                             const ErrorBenchSettings& settings, References& references,
                             FrameCaster& caster, Report& report);

std::vector<RatioRow> measure_storages(const Subject& subject, const ErrorBenchSettings& settings,
                                       FrameCaster& caster);
std::vector<RatioRow> measure_features(const Subject& subject, const ErrorBenchSettings& settings,
                                       FrameCaster& caster);

/// What a new isovalue costs: commit, view and picture.
Contestant isovalue_contestant(const Subject& subject, FrameCaster& caster);

MemoryFigures measure_memory(const Subject& subject);

}  // namespace goldthread::bench
