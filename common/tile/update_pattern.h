// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which samples of a moving picture are cast anew for one displayed frame. A picture has as many
// parts as it takes frames until each sample was cast once; frame f casts part f modulo that.
// Workers cast them, compositors keep them: both ask here. Pure.

#include <cstdint>
#include <vector>

#include "common/base/types.h"
#include "common/tile/refinement.h"
#include "common/tile/sample.h"

namespace goldthread {

/// 1 (all pixels), 2 (a checkerboard's fields), 4 (the pixels of 2×2, diagonal ones first), or as
/// many as a block has Poisson-disk samples.
std::uint32_t parts_of(Update update);

/// Edge of a block of frameless antialiasing, in pixels, and its samples: two in a pixel's area.
constexpr int kFramelessBlock = 4;
constexpr std::uint32_t kFramelessSamples = 32;
/// How many blocks cover so many pixels.
constexpr int blocks_across(int pixels) { return (pixels + kFramelessBlock - 1) / kFramelessBlock; }

/// The samples of a block in pixels from its corner, in the order in which they were chosen: each
/// next one the farthest of many candidates from all before, on a torus (Mitchell 1991, "Spectrally
/// optimal sampling for distribution ray tracing"), so that any first few are spread as well.
const std::vector<PixelPosition>& frameless_pattern();

/// A sample of a rectangle of the image.
struct UpdatePlace {
  std::uint32_t index = 0;  ///< among all of the rectangle: update_places() says how many
  PixelPosition position;   ///< in the image
};

/// How many samples the rectangle has in all parts. Pixels row by row; for kFrameless blocks row by
/// row, those at the right and lower edges whole, and each one's samples in the pattern's order.
std::uint32_t update_places(const PixelRect& rect, Update update);

/// The samples of a part, in blocks of 16 neighbours for the sake of coherent packets. A rectangle
/// that lies on multiples of kFramelessBlock, as tiles do, has the same ones whether it is asked
/// for alone or as part of a larger one. Blocks begin the pattern at different samples, so that no
/// grid is seen.
std::vector<UpdatePlace> places_of(const PixelRect& rect, Update update, std::uint32_t part);

/// The part that a place belongs to.
std::uint32_t part_of(const PixelRect& rect, Update update, std::uint32_t index);

}  // namespace goldthread
