// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the bench measures of adaptive refinement, at one size: pictures refined to several targets,
// first pictures, and beside them, in the same rounds, VTK and pictures of every pixel.

#include <deque>
#include <map>
#include <tuple>
#include <vector>

#include "bench/error/adaptive_method.h"
#include "bench/error/bench_error.h"
#include "bench/error/peer_measurements.h"
#include "bench/error/rounds.h"
#include "bench/error/truth.h"

namespace goldthread::bench {

class AdaptiveMeasurements {
 public:
  /// `peers` may be null.
  AdaptiveMeasurements(const Subject& subject, ImageSize size, const ErrorBenchSettings& settings,
                       PeerMeasurements* peers);

  /// Every look at every target. `report` holds VTK's alignments already.
  void measure(Report& report);
  /// One target with rays of several steps.
  void measure_ray_steps(AdaptiveReport& report);
  /// Step after step of the golden thread.
  void measure_calibration(AdaptiveReport& report);
  /// The truths that were needed.
  const std::vector<TruthRow>& truths() const { return truth_rows_; }

 private:
  struct Entry {
    Look look;
    double target;  ///< 0: none
    double step_voxels;
    AdaptiveMethod method;
  };

  void add(Look look, double target, double step_voxels, const Aim& aim);
  void add_every_pixel();
  void add_vtk();
  void run_rounds(const char* what);
  AdaptiveRow row_of(std::size_t i);
  void add_every_pixel_rows(AdaptiveReport& report);
  void add_vtk_rows(Report& report);
  const std::vector<Color>& truth(Look look, Shift shift = {});
  double error_of(AdaptiveMethod& method, Look look);
  /// In voxels, as `render` would choose it.
  double step_for(Look look, double target) const;

  Subject subject_;
  const ErrorBenchSettings& settings_;
  PeerMeasurements* peers_;
  AdaptiveCaster caster_;
  FrameCaster frames_;
  int stride_;
  std::deque<Entry> entries_;
  std::deque<OwnMethod> every_pixel_;
  std::vector<Look> vtk_;
  std::vector<Contestant> contestants_;  ///< entries, then every pixel, then VTK
  std::map<std::tuple<Look, double, double>, std::vector<Color>> truths_;
  std::vector<TruthRow> truth_rows_;
};

/// At the scene's size and at twice that.
void measure_adaptive(const Subject& subject, const ErrorBenchSettings& settings,
                      PeerMeasurements* peers, Report& report);

}  // namespace goldthread::bench
