// SPDX-License-Identifier: Apache-2.0
#pragma once
// How the camera moves in the bench of motion: closed forms of time, so that every machine and
// every method sees the same. All turn about the target of the camera at rest.

#include <functional>
#include <string>
#include <vector>

#include "common/scene/scene.h"

namespace goldthread::bench {

struct CameraPath {
  std::string name;
  std::string about;  ///< for readers of the report
  std::function<Camera(double seconds)> at;
};

/// How long a path is, and how often a page sends its camera.
constexpr double kPathSeconds = 4;
constexpr double kInputsPerSecond = 1000;

/// - slow orbit: 20° a second
/// - fast turn: 90° a second
/// - stop and go: in turn half a second at 60° a second and half a second at rest
/// - jitter: a head that looks on, turning to both sides and nodding by ±0.5° at 1.1 and 1.7 Hz,
/// with a
///   tremor of ±0.05° at 8.3 and 9.1 Hz
std::vector<CameraPath> camera_paths(const Camera& rest);

/// The newest camera that has come at a time: inputs are kInputsPerSecond apart.
Camera newest_input(const CameraPath& path, double seconds);

}  // namespace goldthread::bench
