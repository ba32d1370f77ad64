// SPDX-License-Identifier: Apache-2.0
#pragma once
// Methods on a path of the camera: a display that looks at each every 60th of a second, and how far
// what it sees is from the picture that a renderer without any latency would show then.

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "bench/motion/camera_paths.h"
#include "bench/motion/motion_method.h"

namespace goldthread::bench {

constexpr double kDisplaysPerSecond = 60;
/// The first pictures of a session are not a matter of motion: errors count from here on.
constexpr double kWarmUpSeconds = 0.25;

/// What a display has seen of one method, from kWarmUpSeconds on.
struct Showing {
  std::vector<double> seconds;     ///< of each look
  std::vector<double> rms;         ///< error in 1/255 of a displayed channel
  std::vector<double> latency;     ///< seconds since the newest camera in the picture
  double pictures_per_second = 0;  ///< that differ, as the display sees them

  double mean_rms() const;
  double percentile95_rms() const;  ///< nearest rank
  double mean_latency() const;
};

/// Root mean square over all channels of all pixels, in 1/255; both hold the same pixels.
double rms_error(std::span<const Color> shown, std::span<const Color> exact);

struct PlaybackSettings {
  double seconds = kPathSeconds;
  int threads = 1;  ///< real ones, each for a method
  std::function<void(double fraction)> progress = [](double) {};
};

/// One for each method. `exact` renders a camera without latency.
std::vector<Showing> play(const CameraPath& path,
                          std::span<const std::unique_ptr<MotionMethod>> methods,
                          const std::function<std::vector<Color>(const Camera&)>& exact,
                          const PlaybackSettings& settings);

}  // namespace goldthread::bench
