// SPDX-License-Identifier: Apache-2.0
#pragma once
// Through which slabs the rays of a view go, and in which order. Pure.

#include <vector>

#include "common/scene/camera.h"
#include "common/tile/sample.h"
#include "common/volume/slab.h"
#include "common/volume/volume.h"
#include "worker/kernels/kernel_types.h"

namespace goldthread {

/// Slabs first … last, in the order of depth: ascending along z, or descending. Rays that miss the
/// volume have none.
struct SlabPath {
  int first = 0;
  int last = -1;
  bool descends = false;
  bool crosses(int slab) const { return slab >= first && slab <= last; }
};

class SlabPaths {
 public:
  SlabPaths(const Camera& camera, ImageSize image, const VolumeGeometry& geometry, int slabs);
  /// All slabs that may have a segment of the ray: those it touches, and with a voxel to spare.
  SlabPath of(PixelPosition position) const;
  int slabs() const { return static_cast<int>(first_voxels_.size()); }

 private:
  int slab_at(double z) const;

  KernelView view_;
  glm::dvec3 highest_;                ///< voxel indices
  std::vector<double> first_voxels_;  ///< of each slab, along z
};

}  // namespace goldthread
