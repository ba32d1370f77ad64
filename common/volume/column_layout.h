// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where a voxel lies in memory. Voxels form columns along z with a footprint of 4×4 voxels in x and
// y: a slice of a column is 16 elements, x fastest, and slices follow each other along z. So any
// 8×8×8 neighbourhood that starts at a multiple of 4 in x and y, and anywhere in z, is four runs of
// 128 elements: tables that fit into registers, from which a packet of neighbouring rays takes its
// voxels without a gather.
//
// Elements are bytes: voxels of several bytes are split into planes, the lowest byte first, one
// behind the other in each column. All around the volume lies one voxel that repeats its border;
// "stored" coordinates count from there, voxel + 1.

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>

#include "common/volume/slab.h"

namespace goldthread {

struct ColumnLayout {
  static constexpr int kEdge = 4;    ///< of a column's footprint, in voxels
  static constexpr int kSlice = 16;  ///< bytes of one slice of one plane
  static constexpr int kWindow = 8;  ///< edge of the neighbourhoods that can be addressed
  static constexpr int kApron = 1;   ///< voxels repeated beyond each border

  glm::ivec3 size{0, 0, 0};      ///< voxels
  int planes = 1;                ///< bytes of a voxel
  glm::ivec2 columns{0, 0};      ///< in x and y, at least 2 each
  int first_slice = 0;           ///< stored z of the first slice that is there
  int slices = 0;                ///< of a column in use, at least kWindow
  std::int64_t plane_bytes = 0;  ///< of one plane of one column

  ColumnLayout() = default;
  ColumnLayout(glm::ivec3 voxels, int bytes_per_voxel)
      : ColumnLayout(voxels, bytes_per_voxel, whole_slab(voxels.z)) {}
  /// Of a slab of `voxels`.
  ColumnLayout(glm::ivec3 voxels, int bytes_per_voxel, const Slab& slab)
      : size(voxels),
        planes(bytes_per_voxel),
        columns(glm::max((glm::ivec2(voxels) + 2 * kApron + kEdge - 1) / kEdge, 2)),
        first_slice(stored_slices(slab, voxels.z).first),
        slices(std::max(stored_slices(slab, voxels.z).count(), kWindow)) {
    // An odd number of cache lines: equal places of neighbouring columns fall into different sets.
    const std::int64_t lines = (std::int64_t(slices) * kSlice + kLine - 1) / kLine;
    plane_bytes = (lines | 1) * kLine;
  }

  std::int64_t column_bytes() const { return plane_bytes * planes; }
  std::int64_t row_bytes() const { return column_bytes() * columns.x; }  ///< of columns along x
  std::int64_t byte_count() const { return row_bytes() * columns.y; }

  /// The first byte of a voxel, given by its stored coordinates; the others follow plane_bytes
  /// apart.
  std::int64_t offset(int x, int y, int z) const {
    return (y / kEdge) * row_bytes() + (x / kEdge) * column_bytes() +
           std::int64_t(z - first_slice) * kSlice + (y % kEdge) * kEdge + x % kEdge;
  }

 private:
  static constexpr int kLine = 64;
};

}  // namespace goldthread
