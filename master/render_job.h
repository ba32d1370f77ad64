// SPDX-License-Identifier: Apache-2.0
#pragma once
// One finished picture of a scene: what `goldthread render` does once per frame.

#include <functional>
#include <optional>
#include <vector>

#include "master/cluster.h"
#include "master/stop_rule.h"
#include "master/tile_cut.h"

namespace goldthread {

struct RenderRequest {
  ViewCut cut;
  StopRule stop;
  Filter filter = Filter::kBilinear;
  /// Stop after this long with what is there by then, but at least the first step.
  std::optional<std::chrono::duration<double>> time;
  std::function<void(double fraction)> progress = [](double) {};
  std::function<void(Rank rank)> worker_lost = [](Rank) {};
  /// Asked now and then; true ends the job with a FatalError.
  std::function<bool()> interrupted = [] { return false; };
};

struct RenderedFrame {
  ImageSize size;
  std::vector<float> rgba;  ///< over the background, premultiplied, rows from the top
  ViewState view;           ///< of how it came about
};

/// `scene` must be resolved and committed to the cluster.
RenderedFrame render_frame(Cluster& cluster, const Scene& scene, const RenderRequest& request);

}  // namespace goldthread
