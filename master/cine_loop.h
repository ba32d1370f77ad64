// SPDX-License-Identifier: Apache-2.0
#pragma once
// The picture at rest rocked to and fro, so that depth is seen by the movement: which cameras, in
// which order they are rendered, and which one is next. Pure.

#include <optional>
#include <vector>

#include "common/scene/camera.h"

namespace goldthread {

constexpr int kCineFrames = 7;
/// How far the outermost cameras are turned to either side.
constexpr double kCineSwingDeg = 12;

/// Cameras turned about the target along the up axis in equal steps from −`swing_deg` to
/// +`swing_deg` (counter-clockwise as orbit()). `frames` is odd; the middle one is `rest` itself.
std::vector<Camera> rocking_cameras(const Camera& rest, int frames = kCineFrames,
                                    double swing_deg = kCineSwingDeg);

/// Indices 0 … frames−1: the middle first, which is there already, then outwards to both sides, so
/// that what is rendered so far always rocks evenly.
std::vector<int> rendering_order(int frames);

/// Idle until begin(); then its frames one after the other; then complete, until reset() or another
/// begin(). Every input resets it.
class CineLoop {
 public:
  void begin(const Camera& rest, int frames = kCineFrames, double swing_deg = kCineSwingDeg);
  void reset();
  /// The frame that is being rendered is done: the next one is.
  void frame_done();

  bool idle() const { return cameras_.empty(); }
  bool complete() const { return !idle() && done_ == order_.size(); }
  int frames() const { return static_cast<int>(cameras_.size()); }
  /// Which frame of the loop is being rendered, from 0; nothing when idle or complete.
  std::optional<int> frame() const;
  /// Its camera; there must be a frame().
  const Camera& camera() const;

 private:
  std::vector<Camera> cameras_;
  std::vector<int> order_;
  std::size_t done_ = 0;
};

}  // namespace goldthread
