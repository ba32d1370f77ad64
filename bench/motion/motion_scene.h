// SPDX-License-Identifier: Apache-2.0
#pragma once
// The scene that is looked at in motion, rays through it whose cost is counted, and pictures of
// them.

#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "bench/error/statistics.h"
#include "bench/error/subject.h"
#include "bench/motion/motion_method.h"
#include "worker/ray_caster.h"

namespace goldthread::bench {

/// Processor time of the calling thread, in seconds: what else the machine does is not in it.
double thread_seconds();
/// What `work` takes of it.
double thread_seconds_of(const std::function<void()>& work);

struct MotionScene {
  std::shared_ptr<const CommittedScene> committed;
  ImageSettings image;
  Camera rest;
  std::vector<glm::dvec3> points;  ///< whose movement is the temporal error
  int threads = 1;                 ///< of the machine
  double cost_factor = 1;          ///< how much slower it is to be than this one

  /// What it takes the whole machine, from seconds of one thread of this one.
  double shared(double thread_seconds) const { return cost_factor * thread_seconds / threads; }
  /// And what only one thread can do.
  double alone(double thread_seconds) const { return cost_factor * thread_seconds; }

  PixelRect rect() const { return {0, 0, image.size.width, image.size.height}; }
};

MotionScene motion_scene(const Subject& subject, int threads);

/// The rays of one camera, cast by the calling thread in batches as a worker does.
class CountedRays {
 public:
  CountedRays(const MotionScene& scene, const Camera& camera);
  /// `surfaces` empty or as long as positions.
  void cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
            std::span<std::uint32_t> surfaces = {});
  bool has_surfaces() const { return source_->has_surfaces(); }
  /// Thread time since the camera was made.
  double seconds() const { return seconds_; }

 private:
  std::shared_ptr<const SampleSource> source_;
  double seconds_ = 0;
};

/// One sample for each pixel, row by row, over the background as it is displayed. What this takes
/// is not counted: every method needs it alike.
ShownPicture shown_picture(std::span<const Sample> pixels, const ImageSettings& image,
                           double input_seconds);

/// A ray in each pixel's centre; `seconds` of a thread.
struct FullFrame {
  std::vector<Sample> pixels;
  double seconds = 0;
};
FullFrame full_frame(const MotionScene& scene, const Camera& camera);

/// What all methods are held against: displayed colours, the mean over each pixel of 3×3 rays.
/// filtered_truth() takes some 160 of them, which is too many for a picture at each 1/60 s.
std::vector<Color> true_picture(const MotionScene& scene, const Camera& camera);

}  // namespace goldthread::bench
