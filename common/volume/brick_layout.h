// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where a voxel lies in memory. Bricks of 32×8×8 voxels; each row of a brick also holds its left
// neighbour and its next two on the right, so that a gather fetches x−1 … x+2 from one place.
// The offset is a sum of one function per axis, each two multiplications: cheap in SIMD.

#include <cstdint>
#include <glm/glm.hpp>

namespace goldthread {

struct BrickLayout {
  static constexpr int kEdgeX = 32, kEdgeY = 8, kEdgeZ = 8;
  static constexpr int kShiftX = 5, kShiftY = 3, kShiftZ = 3;
  static constexpr int kLeft = 1;  ///< neighbours kept in front of a row
  static constexpr int kRow = 36;  ///< elements of a row: 1 + 32 + 2, and 1 unused
  static constexpr int kSlice = kRow * kEdgeY;
  static constexpr int kBrick = kSlice * kEdgeZ;  ///< elements of a brick

  glm::ivec3 size{0, 0, 0};    ///< voxels
  glm::ivec3 bricks{0, 0, 0};  ///< bricks along each axis

  BrickLayout() = default;
  explicit BrickLayout(glm::ivec3 voxels)
      : size(voxels),
        bricks((voxels.x + kEdgeX - 1) / kEdgeX, (voxels.y + kEdgeY - 1) / kEdgeY,
               (voxels.z + kEdgeZ - 1) / kEdgeZ) {}

  /// offset = x·1 + (x >> kShiftX)·brick_step().x + kLeft + y·kRow + (y >> kShiftY)·brick_step().y
  ///        + z·kSlice + (z >> kShiftZ)·brick_step().z, in elements.
  glm::i64vec3 brick_step() const {
    const std::int64_t row_of_bricks = std::int64_t(bricks.x) * kBrick;
    return {kBrick - kEdgeX, row_of_bricks - std::int64_t(kEdgeY) * kRow,
            row_of_bricks * bricks.y - std::int64_t(kEdgeZ) * kSlice};
  }
  std::int64_t offset(int x, int y, int z) const {
    const auto step = brick_step();
    return x + (x >> kShiftX) * step.x + kLeft + std::int64_t(y) * kRow + (y >> kShiftY) * step.y +
           std::int64_t(z) * kSlice + (z >> kShiftZ) * step.z;
  }
  /// Elements in all bricks.
  std::int64_t element_count() const {
    return std::int64_t(bricks.x) * bricks.y * bricks.z * kBrick;
  }
};

}  // namespace goldthread
