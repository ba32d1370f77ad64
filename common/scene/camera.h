// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a camera means geometrically: its axes, its rays, and turning it. Pure functions; world
// units are millimetres, and pixels are square, so that the width follows from fovy and the size.

#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "common/base/types.h"
#include "common/scene/scene.h"

namespace goldthread {

/// Right-handed orthonormal axes of a camera in the world: `right` towards growing pixel x, `up`
/// towards falling pixel y, `forward` towards the target.
struct CameraBasis {
  glm::dvec3 right{1, 0, 0};
  glm::dvec3 up{0, 1, 0};
  glm::dvec3 forward{0, 0, -1};
};

struct Ray {
  glm::dvec3 origin{0, 0, 0};
  glm::dvec3 direction{0, 0, 1};  ///< of unit length
};

/// What makes a camera useless: `what` completes a sentence about `field` ("up").
struct CameraFault {
  std::string field;
  std::string what;
  std::string mend;
  bool any() const { return !what.empty(); }
};

/// Not any() if all is finite, position and target are apart, up is neither zero nor parallel to
/// the view direction, and 0 < fovy < 180.
CameraFault camera_fault(const Camera& camera);

/// `camera` must be without fault.
CameraBasis camera_basis(const Camera& camera);

/// The ray through (x, y), in pixels from the top left corner of an image of this size; pixel
/// (i, j) has its centre at (i + 0.5, j + 0.5). Positions outside the image are as good as inside.
Ray camera_ray(const Camera& camera, ImageSize size, double x, double y);

/// Where points of the world are seen in an image of this size: the inverse of camera_ray.
class Projection {
 public:
  /// `camera` must be without fault.
  Projection(const Camera& camera, ImageSize size);
  /// In pixels from the top left corner, inside the image or not; nothing for a point that is not
  /// in front of the camera.
  std::optional<glm::dvec2> at(const glm::dvec3& point_mm) const;

 private:
  CameraBasis basis_;
  glm::dvec3 position_;
  glm::dvec2 centre_;
  double pixel_;  ///< a pixel's edge at distance 1
};

/// The camera turned by `degrees` about the axis through its target along `up`, counter-clockwise
/// seen from the tip of `up`. Whole turns give the same camera to the bit.
Camera orbit(const Camera& camera, double degrees);

}  // namespace goldthread
