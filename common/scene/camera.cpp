// SPDX-License-Identifier: Apache-2.0
#include "common/scene/camera.h"

#include <algorithm>
#include <cmath>

namespace goldthread {
namespace {

/// Sine of the least angle between up and the view direction: below, roundoff would turn the image.
constexpr double kLeastSine = 1e-6;

bool is_finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// `v` scaled by its greatest component first, so that no square over- or underflows.
glm::dvec3 unit(const glm::dvec3& v) {
  const double scale = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return glm::normalize(v / scale);
}

/// A pixel's edge at distance 1: half the image's height spans tan(fovy/2); pixels are square.
double pixel_edge(const Camera& camera, ImageSize size) {
  return 2 * std::tan(glm::radians(camera.fovy_deg) / 2) / size.height;
}

}  // namespace

CameraFault camera_fault(const Camera& camera) {
  if (!is_finite(camera.position)) return {"position", "is not finite", "give three numbers"};
  if (!is_finite(camera.target)) return {"target", "is not finite", "give three numbers"};
  if (!is_finite(camera.up)) return {"up", "is not finite", "give three numbers"};
  if (!(camera.fovy_deg > 0 && camera.fovy_deg < 180)) {
    return {"fovy", "must lie between 0 and 180 degrees", "30 is usual"};
  }
  const glm::dvec3 view = camera.target - camera.position;
  if (view == glm::dvec3(0) || !is_finite(view)) {
    return {"target", "is the camera's own position", "move one of them"};
  }
  if (camera.up == glm::dvec3(0)) return {"up", "has no direction", "[0, 0, 1] is usual"};
  if (glm::length(glm::cross(unit(view), unit(camera.up))) < kLeastSine) {
    return {"up", "is parallel to the view direction", "choose another axis"};
  }
  return {};
}

CameraBasis camera_basis(const Camera& camera) {
  CameraBasis basis;
  basis.forward = unit(camera.target - camera.position);
  basis.right = glm::normalize(glm::cross(basis.forward, unit(camera.up)));
  basis.up = glm::cross(basis.right, basis.forward);
  return basis;
}

Ray camera_ray(const Camera& camera, ImageSize size, double x, double y) {
  const CameraBasis basis = camera_basis(camera);
  const double pixel = pixel_edge(camera, size);
  const double right = (x - size.width * 0.5) * pixel;
  const double up = (size.height * 0.5 - y) * pixel;
  return {camera.position, glm::normalize(basis.forward + right * basis.right + up * basis.up)};
}

Projection::Projection(const Camera& camera, ImageSize size)
    : basis_(camera_basis(camera)),
      position_(camera.position),
      centre_(size.width * 0.5, size.height * 0.5),
      pixel_(pixel_edge(camera, size)) {}

std::optional<glm::dvec2> Projection::at(const glm::dvec3& point_mm) const {
  const glm::dvec3 seen = point_mm - position_;
  const double depth = glm::dot(seen, basis_.forward);
  if (!(depth > 0)) return {};
  const double scale = 1 / (depth * pixel_);
  return glm::dvec2(centre_.x + glm::dot(seen, basis_.right) * scale,
                    centre_.y - glm::dot(seen, basis_.up) * scale);
}

Camera orbit(const Camera& camera, double degrees) {
  const double turn = std::fmod(degrees, 360.0);
  if (turn == 0) return camera;
  const glm::dvec3 axis = unit(camera.up);
  const glm::dvec3 arm = camera.position - camera.target;
  const double c = std::cos(glm::radians(turn)), s = std::sin(glm::radians(turn));
  // Rodrigues' rotation.
  const glm::dvec3 turned =
      arm * c + glm::cross(axis, arm) * s + axis * (glm::dot(axis, arm) * (1 - c));
  Camera result = camera;
  result.position = camera.target + turned;
  return result;
}

}  // namespace goldthread
