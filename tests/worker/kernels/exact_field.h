// SPDX-License-Identifier: Apache-2.0
#pragma once
// The field of a volume as it is defined, in double: trilinear between the voxels, empty in cells
// with a voxel that is not finite; rays through it cell by cell, and every crossing of an isovalue,
// isolated between the turns of the cubic (Marmitt et al. 2004) and found by bisection.

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "cast_support.h"

namespace goldthread::test {

/// A ray in voxel indices; its parameter is millimetres from the camera.
struct IndexRay {
  glm::dvec3 origin{0, 0, 0};
  glm::dvec3 direction{0, 0, 0};  ///< voxels per mm
  glm::dvec3 world{0, 0, 0};      ///< the unit direction in the world
  glm::dvec3 at(double t_mm) const { return origin + direction * t_mm; }
};
IndexRay index_ray(const Scene& scene, const VolumeGeometry& geometry, PixelPosition position);

/// The piece of a ray inside one cell of 2³ voxels.
struct CellSpan {
  glm::ivec3 cell;
  double begin_mm, end_mm;
};

/// A value on a ray.
struct Place {
  double t_mm;
  double value;
};

/// Where a ray crosses an isovalue.
struct Crossing {
  double t_mm;
  bool rising;
  double slope;  ///< |df/dt| in ranges of the cell per cell
};

/// The crossings of one ray, and how far the nearest turn of the field along it stays away from
/// the isovalue, in ranges of its cell: nearer than roundoff, a crossing may be gained or lost.
struct Crossings {
  std::vector<Crossing> hits;
  double clearance = 1;
};

/// c0 + c1·s + c2·s² + c3·s³ over s in [0, 1]: what a trilinear field is on a ray inside a cell.
struct Cubic;

class ExactField {
 public:
  explicit ExactField(const Volume& volume);

  const VolumeGeometry& geometry() const { return geometry_; }
  const glm::dmat3& world_from_index() const { return world_from_index_; }
  /// The cells on a ray in its order, bad ones too; none where it misses.
  std::vector<CellSpan> spans(const IndexRay& ray) const;
  bool is_finite(const glm::ivec3& cell) const;
  /// Where the ray enters finite cells, turns in them and leaves them: monotone in between.
  std::vector<Place> turns(const IndexRay& ray) const;
  /// Trilinear in the cell, also a little outside of it.
  double value(const glm::ivec3& cell, const glm::dvec3& index) const;
  /// Central differences at the voxels, clamped at the border, interpolated; world, per mm.
  glm::dvec3 gradient(const glm::ivec3& cell, const glm::dvec3& index) const;
  Crossings crossings(const IndexRay& ray, double isovalue) const;

 private:
  double voxel(const glm::ivec3& at) const;
  /// Minus `level`, over the way through the cell from 0 to 1.
  Cubic cubic_in(const IndexRay& ray, const CellSpan& span, double level) const;
  glm::dvec3 central_difference(const glm::ivec3& at) const;

  VolumeGeometry geometry_;
  glm::dmat3 world_from_index_;
  glm::dmat3 covector_map_;  ///< inverse transpose of world_from_index_
  std::vector<double> voxels_;
};

}  // namespace goldthread::test
