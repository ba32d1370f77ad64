// SPDX-License-Identifier: Apache-2.0
#pragma once
// Frames of several methods in turn: one of each, then again one of each the other way round, so
// that whatever else the machine does falls on all alike. A method that fails is left out of later
// rounds.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/error/frame.h"
#include "bench/error/statistics.h"
#include "worker/ray_caster.h"

namespace goldthread::bench {

struct Contestant {
  std::string name;
  std::function<double()> frame;  ///< makes one and says how many seconds it took
  std::vector<double> seconds = {};
  std::string failure = {};  ///< what a PeerFailure said
};

/// After one frame of each that does not count. `progress` is told the share that is done.
void run_rounds(std::vector<Contestant>& contestants, int rounds,
                const std::function<void(double)>& progress);

/// How long `work` takes.
double seconds_of(const std::function<void()>& work);

/// Two contestants' times against each other: the median of the rounds' ratios, which whatever
/// falls on a whole round leaves as it is, and the ratio of the quickest frames.
double median_ratio(const Contestant& one, const Contestant& base);
double ratio_of_minima(const Contestant& one, const Contestant& base);

/// A committed scene of ours that can be rendered again and again.
class OwnMethod {
 public:
  OwnMethod(Scene scene, std::shared_ptr<const Volume> volume);

  /// The whole picture: what depends on the view is made anew, as for each frame of a session.
  double frame_seconds(FrameCaster& caster);
  const CastCounts& counts() const { return counts_; }
  std::string kernel() const { return kernel_name(*committed_); }
  const Scene& scene() const { return scene_; }

 private:
  Scene scene_;
  std::shared_ptr<const CommittedScene> committed_;
  CastCounts counts_;
};

}  // namespace goldthread::bench
