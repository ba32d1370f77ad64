// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the bench measures of other renderers. Whatever one of them lacks, the reason goes into the
// report and the bench goes on.

#include <optional>
#include <string>
#include <vector>

#include "bench/error/bench_error.h"
#include "bench/error/peers.h"
#include "bench/error/references.h"
#include "bench/error/rounds.h"

namespace goldthread::bench {

class PeerMeasurements {
 public:
  PeerMeasurements(const Subject& subject, const ErrorBenchSettings& settings);

  /// VTK's frames, for the rounds in which ours are made; none if VTK cannot be had.
  std::vector<Contestant> vtk_contestants();
  /// Rows of those, `contestants` as vtk_contestants() gave them, rounds run.
  std::vector<MethodRow> vtk_rows(const std::vector<Contestant>& contestants,
                                  References& references);
  /// The error of VTK's surface for the isovalue, as a row without a time.
  std::optional<MethodRow> vtk_surface_row(References& references);
  std::optional<Contestant> vtk_isovalue_contestant();
  /// VTK's frames of one look, at any size; nothing if VTK cannot be had.
  std::optional<Contestant> vtk_contestant(Look look, double step_voxels, ImageSize size);
  /// Every `stride`-th pixel of such a frame.
  std::optional<std::vector<Color>> vtk_picture(Look look, double step_voxels, ImageSize size,
                                                int stride);
  /// VTK's time and ours from the start of a process to its first picture.
  std::vector<Contestant> start_contestants();

  /// Ends VTK, and runs ParaView between two series of `own` frames.
  void measure_paraview(OwnMethod& own, FrameCaster& caster, References& references,
                        Report& report);

  /// VTK's and ParaView's, once all is measured.
  std::vector<PeerRow> rows() const { return {vtk_row_, paraview_row_}; }

 private:
  struct VtkEntry {
    Look look;
    double step_voxels;
  };
  /// A row without times, the error at its best alignment.
  MethodRow aligned_row(const char* program, Look look, double step_voxels,
                        const std::vector<Color>& picture, References& references) const;

  const Subject& subject_;
  const ErrorBenchSettings& settings_;
  PeerSettings peer_settings_;
  PeerRow vtk_row_{"VTK", "", ""};
  PeerRow paraview_row_{"ParaView", "", ""};
  std::vector<VtkEntry> vtk_entries_;
  std::optional<VirtualDisplay> display_;
  std::optional<PeerJob> job_;
  std::optional<VtkPeer> vtk_;
};

}  // namespace goldthread::bench
