// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where a pixel's samples lie. The first is in its centre; the others follow a two-dimensional
// Sobol sequence with Owen's scrambling (Burley 2020, "Practical Hash-based Owen Scrambling"),
// another scrambling for each pixel. Each prefix whose length is a power of two is stratified, and
// the sequence never ends. Positions depend on the pixel and the sample's number alone.

#include <cstdint>

#include "common/tile/sample.h"

namespace goldthread {

/// Sample `number` of the pixel (x, y) of the image. Within the image's largest sizes positions are
/// kept to 1/1024 pixel.
PixelPosition sample_position(int x, int y, std::uint32_t number);

}  // namespace goldthread
