// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which cells of a volume can show anything under a transfer function and isosurfaces, and how far
// each of the others is from one that can.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "common/scene/scene.h"
#include "common/volume/volume.h"

namespace goldthread {

/// Decides from the opacity nodes themselves: a cell is invisible only where extinction is exactly
/// 0 over its whole range, widened by a margin, and no isovalue lies in it. With a row of the
/// transfer table as the margin, sampling an invisible cell gives exactly 0 too, so that it does
/// not matter whether a ray leaps over it.
class CellVisibility {
 public:
  /// `function` may be null. Values are data values; ranges given later are stored ones.
  CellVisibility(const TransferFunction* function, std::span<const Isosurface> isosurfaces,
                 double value_bias, double margin = 0);
  bool operator()(CellRange stored) const;

 private:
  bool has_extinction(double minimum, double maximum) const;

  std::vector<OpacityNode> nodes_;
  std::vector<std::size_t> opaque_before_;  ///< nodes with opacity among the first i
  std::vector<double> isovalues_;           ///< ascending
  double value_bias_;
  double margin_;
};

/// Chebyshev distances in cells, 0 where visible, at most 255, x fastest; and 3 bytes of padding
/// for gathers of 32 bits. Exact for distances up to 255.
std::vector<std::uint8_t> distances_to_visible(std::span<const CellRange> cells, glm::ivec3 counts,
                                               const CellVisibility& visible);

}  // namespace goldthread
