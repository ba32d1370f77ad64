// SPDX-License-Identifier: Apache-2.0
#pragma once
// Records cost images: a view is cast as a worker casts it, tile by tile and step by step, and what
// can be counted is kept. Counts are the same each time; what a ray and a field evaluation cost on
// this machine is fitted to all tiles of a step, so one tile that was disturbed does not matter.

#include <cstdint>
#include <vector>

#include "bench/scale/cost_record.h"
#include "bench/scale/linear_fit.h"
#include "common/scene/scene.h"
#include "common/tile/refinement.h"
#include "master/stop_rule.h"
#include "worker/sample_source.h"

namespace goldthread::bench {

/// How a view is cast: step by step until the rule holds, or what an update casts, in one step.
struct Casting {
  StopRule stop;
  Update update = Update::kAll;
};
/// A ray in each pixel's centre, in one step: what a session shows in motion.
constexpr Casting kWholeCasting{{}, Update::kWhole};
/// What `render` does: adaptive refinement to an estimated error of 0.5.
constexpr Casting kRefinedCasting{{}, Update::kAll};

/// What one step of a tile was.
struct CountedStep {
  double rays = 0;
  double samples = 0;  ///< field evaluations
  double bytes = 0;    ///< to the compositor
  double squared_error = 0;
  double thread_us = 0;                   ///< measured, of the thread's processor
  std::vector<std::uint32_t> block_rays;  ///< of the tile's blocks, row by row
};

struct CountedView {
  TileGrid grid;
  std::vector<std::vector<CountedStep>> steps;  ///< of its tiles
  std::vector<double> samples_per_ray;          ///< of the picture's blocks, row by row
};

/// Casts a view. The edges of `image.size` are multiples of 64.
CountedView count_view(const SampleSource& source, const ImageSettings& image,
                       const Casting& casting, int threads);

/// What rays (first) and field evaluations (second) cost in each step, in µs.
std::vector<LinearFit> fit_steps(const CountedView& view);

/// The view's costs in blocks, by these prices of each step.
CostRecord cost_record(const CountedView& view, const std::vector<LinearFit>& prices);

}  // namespace goldthread::bench
