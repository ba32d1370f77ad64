// SPDX-License-Identifier: Apache-2.0
#pragma once
// A view that is refined tile by tile and step by step, as a cluster of one worker and one
// compositor does, with what it costs.

#include <memory>
#include <vector>

#include "bench/motion/motion_scene.h"
#include "common/tile/fill_holes.h"
#include "worker/refinement/tile_refinement.h"

namespace goldthread::bench {

class RefinedView {
 public:
  RefinedView(const MotionScene& scene, const Camera& camera, double input_seconds);

  /// Takes the next tile a step further. Seconds of the whole machine.
  double advance();
  /// The step that every tile has taken.
  Step step() const { return step_; }
  /// Whether no tile is ahead of the others.
  bool is_whole() const { return next_ == 0; }
  /// Of the whole picture.
  TileQuality quality() const;
  const Camera& camera() const { return camera_; }

  /// As it is, holes filled bilinearly; adds what that takes to `seconds`.
  ShownPicture picture(double& seconds);

 private:
  struct Tile {
    PixelRect rect;
    TileRefinement refinement;
    int stride;
    int rows;
    std::vector<Sample> samples;
    std::vector<std::uint8_t> known;
  };
  Tile tile_of(const PixelRect& rect, bool with_surfaces) const;

  const MotionScene& scene_;
  Camera camera_;
  double input_seconds_;
  CountedRays rays_;
  std::vector<Tile> tiles_;
  std::size_t next_ = 0;
  Step step_ = kNoStep;
};

}  // namespace goldthread::bench
