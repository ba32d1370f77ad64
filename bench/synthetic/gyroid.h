// SPDX-License-Identifier: Apache-2.0
#pragma once
// A volume of any size that needs no file to come from: a gyroid inside a ball, a surface that is
// everywhere curved and, as opacity, fine everywhere and opaque nowhere at once. For measuring what
// no file at hand is large enough for.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace goldthread::bench {

/// 8 bits a voxel: 128 + 100·g, g the gyroid sin x cos y + sin y cos z + sin z cos x over 1.5, with
/// `waves` periods along the longest axis, faded to 0 towards the ball's border.
class Gyroid {
 public:
  Gyroid(glm::ivec3 size, double waves);
  std::uint8_t at(int x, int y, int z) const;
  /// Slice z, x fastest: size.x · size.y voxels.
  void slice(int z, std::span<std::uint8_t> to) const;
  glm::ivec3 size() const { return size_; }

 private:
  struct Axis {
    std::vector<float> sine, cosine;
    std::vector<float> square;  ///< of the distance from the middle, the half edge being 1
  };
  static Axis axis_of(int count, double per_voxel);

  glm::ivec3 size_;
  Axis x_, y_, z_;
};

}  // namespace goldthread::bench
