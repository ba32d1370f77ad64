// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which of a list's rays go together in a packet. Rays side by side look up voxels side by side; a
// single one from elsewhere would make all of them look up their own.

#include <algorithm>
#include <cstddef>
#include <span>

#include "common/tile/sample.h"

namespace goldthread {

/// Of how many rays the next packet of at most `most` is: a list is cut before a ray that is more
/// than two blocks of 4×4 pixels away from those before it, if these are close together and fill
/// half a packet.
inline std::size_t packet_size(std::span<const PixelPosition> positions, std::size_t most) {
  constexpr float kClose = 8;  // pixels
  const std::size_t end = std::min(most, positions.size());
  PixelPosition least = positions[0], greatest = positions[0];
  for (std::size_t i = 1; i < end; ++i) {
    const PixelPosition at = positions[i];
    least = {std::min(least.x, at.x), std::min(least.y, at.y)};
    greatest = {std::max(greatest.x, at.x), std::max(greatest.y, at.y)};
    const bool close = greatest.x - least.x <= kClose && greatest.y - least.y <= kClose;
    if (!close) return 2 * i >= most ? i : end;
  }
  return end;
}

}  // namespace goldthread
