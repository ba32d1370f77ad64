// SPDX-License-Identifier: Apache-2.0
#pragma once
// What tests of closed forms share: volumes sampled from functions of the world, transfer functions
// whose extinction is linear between nodes, and where a ray meets the volume.

#include <functional>
#include <memory>
#include <vector>

#include "cast_support.h"

namespace goldthread::test {

using WorldFunction = std::function<double(const glm::dvec3& mm)>;

/// A cube of `edge_mm` with its corner in the origin and n voxels along each edge, as float.
std::shared_ptr<const Volume> sampled_cube(double edge_mm, int n, const WorldFunction& function);

/// The value z/edge in a box of 9×9×n voxels, edge_mm long in z: stored exactly by any n.
std::shared_ptr<const Volume> ramp_along_z(double edge_mm, int n = 33);

struct ExtinctionNode {
  double value;
  double extinction;  ///< 1/mm
};
/// White; extinction linear between nodes to 1e-7: over so short a unit distance opacity is.
TransferFunction linear_extinction(const std::vector<ExtinctionNode>& nodes);
/// Extinction = scale · value for values from 0 to `greatest`.
TransferFunction proportional_extinction(double scale, double greatest);
/// Extinction by a function over values from 0 to 1, through 2048 nodes.
TransferFunction sampled_extinction(const std::function<double(double)>& function);

/// A ray in the world, and where it is inside the cube, in mm from its origin.
struct WorldRay {
  glm::dvec3 origin, direction;
  double entry_mm, exit_mm;
  glm::dvec3 at(double mm) const { return origin + direction * mm; }
};
WorldRay world_ray(const Scene& scene, double edge_mm, PixelPosition position);

/// Unlit emission and absorption seen along +z through the middle of the face, off voxel planes.
Scene axial_scene(const VolumeGeometry& geometry, TransferFunction function);
/// The ray that runs the whole length of the box.
Sample central_ray(const Scene& scene, const std::shared_ptr<const Volume>& volume);

/// The cube seen obliquely; `cast` rays of fan() enter and leave it through different faces.
Scene oblique_scene(double edge_mm, TransferFunction function);
std::vector<PixelPosition> fan(const Scene& scene, int per_edge);

/// Root of the mean square over all rays of kernel − expected opacity.
double rms_opacity_error(const Scene& scene, const std::shared_ptr<const Volume>& volume,
                         const std::vector<PixelPosition>& rays,
                         const std::function<double(PixelPosition)>& expected);

/// What rounding to float may do to a sum over so many segments, relative to its result.
inline double roundoff(double segments) { return (segments + 16) * 0x1p-24; }

}  // namespace goldthread::test
