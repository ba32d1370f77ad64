// SPDX-License-Identifier: Apache-2.0
#pragma once
// One look refined to one aim, again and again.

#include <memory>
#include <vector>

#include "bench/error/adaptive_caster.h"
#include "common/volume/volume.h"
#include "master/stop_rule.h"
#include "worker/ray_caster.h"

namespace goldthread::bench {

/// When a picture is finished: as the product would finish it, or after so many steps.
struct Aim {
  StopRule rule;
  Refinement how;
  Step last = kLastStep;

  /// RMS in 1/255, with nothing shown on the way.
  static Aim at_error(double error);
  /// On the way that a session takes.
  static Aim at_step(Step step) { return {{Sampling::kAdaptive, 0}, {}, step}; }
};

class AdaptiveMethod {
 public:
  /// `scene` with the step that its rays take.
  AdaptiveMethod(Scene scene, std::shared_ptr<const Volume> volume, const Aim& aim);

  /// The whole picture, with what depends on the view.
  double frame_seconds(AdaptiveCaster& caster);
  /// What the last one came to, and its error as the stop rule saw it.
  const Refined& refined() const { return refined_; }
  double estimated_rms() const;
  /// The threads' time in a frame, the median, and in casting its rays alone.
  double cpu_seconds() const { return median(cpu_seconds_); }
  double cast_seconds(AdaptiveCaster& caster, int repeats) const;
  const ImageSettings& image() const { return scene_.image; }

 private:
  std::shared_ptr<const SampleSource> source() const;
  Refined refine(AdaptiveCaster& caster, const SampleSource& source) const;

  Scene scene_;
  std::shared_ptr<const CommittedScene> committed_;
  Aim aim_;
  Refined refined_;
  std::vector<double> cpu_seconds_;
};

}  // namespace goldthread::bench
