// SPDX-License-Identifier: Apache-2.0
#include "worker/slabs/slab_paths.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "worker/kernels/scene_terms.h"

namespace goldthread {
namespace {

/// Voxels by which a ray may be misjudged here: its segments reach a voxel beyond what it touches.
constexpr double kSpare = 1.01;

}  // namespace

SlabPaths::SlabPaths(const Camera& camera, ImageSize image, const VolumeGeometry& geometry,
                     int slabs)
    : view_(kernel_view_of(camera, camera_basis(camera), image, geometry)),
      highest_(geometry.size - 1) {
  for (int i = 0; i < slabs; ++i)
    first_voxels_.push_back(double(slab_of(geometry.size.z, i, slabs).first_layer) * kCellEdge);
}

int SlabPaths::slab_at(double z) const {
  const auto next = std::upper_bound(first_voxels_.begin(), first_voxels_.end(), z);
  return std::max(0, static_cast<int>(next - first_voxels_.begin()) - 1);
}

SlabPath SlabPaths::of(PixelPosition position) const {
  const double u = (double(position.x) - view_.centre_x) * view_.scale;
  const double v = (view_.centre_y - double(position.y)) * view_.scale;
  double entry = 0, exit = std::numeric_limits<double>::infinity();
  double way_z = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double way = view_.forward[axis] + u * view_.right[axis] + v * view_.up[axis];
    const double origin = view_.origin[axis];
    const double low = -kSpare - origin, high = highest_[axis] + kSpare - origin;
    if (axis == 2) way_z = way;
    if (std::abs(way) < 1e-30) {
      if (low > 0 || high < 0) return {};
      continue;
    }
    entry = std::max(entry, std::min(low / way, high / way));
    exit = std::min(exit, std::max(low / way, high / way));
  }
  if (!(entry < exit)) return {};
  const double from = view_.origin[2] + entry * way_z, to = view_.origin[2] + exit * way_z;
  return {slab_at(std::min(from, to) - kSpare), slab_at(std::max(from, to) + kSpare), way_z < 0};
}

}  // namespace goldthread
