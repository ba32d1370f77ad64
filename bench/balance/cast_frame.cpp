// SPDX-License-Identifier: Apache-2.0
#include "bench/balance/cast_frame.h"

#include <cmath>

#include "master/balance.h"

namespace goldthread::bench {
namespace {

constexpr std::chrono::seconds kPatience{60};

/// What all tiles have cost beyond what is in the frame already.
void add_step(const ViewState& view, std::vector<double>& seconds_before, CastFrame& frame) {
  CastFrame::Step step;
  for (std::size_t i = 0; i < view.tiles.size(); ++i) {
    step.us.push_back(1e6 * (view.tiles[i].seconds - seconds_before[i]));
    step.squared_error.push_back(view.tiles[i].quality.squared_error);
    seconds_before[i] = view.tiles[i].seconds;
  }
  frame.steps.push_back(std::move(step));
}

}  // namespace

CastFrame cast_frame(Session& session, const Camera& camera, const ViewRequest& request,
                     const StopRule& rule) {
  Cluster& cluster = session.cluster();
  Scene scene = session.scene();
  scene.camera = camera;
  cluster.begin_view(scene, request);
  const ViewState& view = cluster.view();
  CastFrame frame;
  frame.camera = camera;
  frame.grid = view.grid;
  std::vector<double> seconds_before(view.tiles.size());
  const auto end = Clock::now() + kPatience;
  for (bool enough = false; !enough || view.held < view.cast();) {
    if (Clock::now() > end)
      throw FatalError({"bench", "a frame does not come to its end", "please report this",
                        ExitStatus::kClusterFailed});
    cluster.poll(std::chrono::milliseconds(1));
    if (view.cast().value == frame.steps.size()) continue;
    add_step(view, seconds_before, frame);
    const StepState& last = view.steps.back();
    enough = request.update != Update::kAll ||
             is_enough(rule, view.cast(), last.quality, last.rays, view.pixels());
    if (!enough) cluster.refine_further();
  }
  frame.seconds = view.shown()->held.count();
  frame.imbalance = imbalance(view.worker_seconds);
  return frame;
}

CostHistory history_of(const CastFrame& last, const Camera& next,
                       std::span<const glm::dvec3> points_mm) {
  CostHistory history;
  history.fit(last.grid);
  goldthread::Step at{1};
  for (const CastFrame::Step& step : last.steps) {
    for (std::uint32_t i = 0; i < step.us.size(); ++i)
      history.record({i}, at, std::chrono::microseconds(std::llround(step.us[i])));
    at = at.next();
  }
  history.reproject(last.camera, next, points_mm);
  return history;
}

}  // namespace goldthread::bench
