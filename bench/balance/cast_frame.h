// SPDX-License-Identifier: Apache-2.0
#pragma once
// A frame that a cluster has cast, and what each tile and step of it cost.

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "bench/interrupts/session.h"
#include "master/cost_history.h"
#include "master/stop_rule.h"

namespace goldthread::bench {

struct CastFrame {
  Camera camera;
  TileGrid grid;
  struct Step {
    std::vector<double> us;             ///< processor time, by tile
    std::vector<double> squared_error;  ///< that the tile was left with
  };
  std::vector<Step> steps;
  double seconds = 0;    ///< from its begin until the compositor held it
  double imbalance = 0;  ///< of the workers' processor time
};

/// Casts a frame as a session in motion does (the request's update), or to the end as a render
/// does. Throws FatalError.
CastFrame cast_frame(Session& session, const Camera& camera, const ViewRequest& request,
                     const StopRule& rule);

/// What a frame lets expect of the next one, from another camera; as it is if `points_mm` is empty.
CostHistory history_of(const CastFrame& last, const Camera& next,
                       std::span<const glm::dvec3> points_mm);

}  // namespace goldthread::bench
