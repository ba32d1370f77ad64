// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which cells of a volume can show anything under a transfer function and isosurfaces, and how far
// each is from the next of the other kind.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "common/scene/scene.h"
#include "common/volume/volume.h"
#include "worker/kernels/kernel_types.h"

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

/// Of each cell the Chebyshev distance in cells to the next one of the other kind, visible or
/// empty, at most kMostCellDistance, and kCellIsVisible in visible ones; x fastest; and 3 bytes of
/// padding for gathers of 32 bits.
std::vector<std::uint8_t> cell_distances(std::span<const CellRange> cells, glm::ivec3 counts,
                                         const CellVisibility& visible);

}  // namespace goldthread
