// SPDX-License-Identifier: Apache-2.0
#include "bench/motion/camera_paths.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "common/scene/camera.h"

namespace goldthread::bench {
namespace {

/// Seconds of movement where each half second is followed by another at rest.
double moving_seconds(double seconds) {
  const double whole = std::floor(seconds);
  return 0.5 * whole + std::min(seconds - whole, 0.5);
}

double wave(double hertz, double seconds) {
  return std::sin(2 * glm::pi<double>() * hertz * seconds);
}

/// The target's other axis: the camera turned up or down about it.
Camera nod(const Camera& camera, double degrees) {
  Camera turned = camera;
  const CameraBasis basis = camera_basis(camera);
  turned.up = basis.right;
  turned = orbit(turned, degrees);
  turned.up = camera.up;
  return turned;
}

Camera jittered(const Camera& rest, double seconds) {
  const double aside = 0.5 * wave(1.1, seconds) + 0.05 * wave(8.3, seconds);
  const double down = 0.5 * wave(1.7, seconds) + 0.05 * wave(9.1, seconds);
  return nod(orbit(rest, aside), down);
}

}  // namespace

std::vector<CameraPath> camera_paths(const Camera& rest) {
  return {{"slow orbit", "20° a second", [rest](double t) { return orbit(rest, 20 * t); }},
          {"fast turn", "90° a second", [rest](double t) { return orbit(rest, 90 * t); }},
          {"stop and go", "half a second at 60° a second, half a second at rest",
           [rest](double t) { return orbit(rest, 60 * moving_seconds(t)); }},
          {"jitter", "a head that looks on: ±0.5° at 1.1 and 1.7 Hz, ±0.05° at 8.3 and 9.1 Hz",
           [rest](double t) { return jittered(rest, t); }}};
}

Camera newest_input(const CameraPath& path, double seconds) {
  // A little more, lest the roundoff of a time that is a whole input take the one before.
  return path.at(std::floor(seconds * kInputsPerSecond + 1e-6) / kInputsPerSecond);
}

}  // namespace goldthread::bench
