// SPDX-License-Identifier: Apache-2.0
#pragma once
// The two errors of a picture that is shown while the camera moves, both in pixels, so that they
// can be weighed against each other (Woolley, Luebke, Watson & Dayal 2003, "Interruptible
// rendering"): how coarse it is, and how late. Pure.

#include <span>

#include "common/scene/camera.h"

namespace goldthread {

/// Errors above this are all alike.
constexpr double kLargestSpatialErrorPx = 64;

/// How late: root mean square movement of the points, in pixels, from where the camera of the
/// picture sees them to where the newest camera does. Points that neither has in front of it do not
/// count; one that only one of them has moves by the picture's height, which is also the most that
/// any point moves. 0 without points. Both cameras must be without fault.
double temporal_error_px(std::span<const glm::dvec3> points_mm, const Camera& shown,
                         const Camera& newest, ImageSize size);

/// The shift of a whole picture that changes its colours as much as a movement of one pixel of the
/// points in it. Less than 1, since what turns keeps its outlines nearly where they are, and they
/// have the strongest gradients. Measured with the default head: 0.40 to 0.45; the gradients in
/// TileQuality, taken over some pixels, say 0.55 to 0.8 of it.
constexpr double kShiftOfMovement = 0.5;

/// How coarse: the movement that would change the picture's colours as much as its error does. Both
/// sums are over the same pixels (TileQuality): `squared_error` of colours, `squared_gradient` of
/// colours per pixel. At most kLargestSpatialErrorPx; a picture without gradient has that if it has
/// any error.
double spatial_error_px(double squared_error, double squared_gradient);

/// How coarse a picture of pixel centres is: an edge in it is off by up to half a pixel, 1/√12 in
/// the root mean square.
constexpr double kCentresPx = 0.288675134594813;

}  // namespace goldthread
