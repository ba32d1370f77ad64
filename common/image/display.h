// SPDX-License-Identifier: Apache-2.0
#pragma once
// What is shown of computed pixels: the one place where they become 8 bits, so that the browser at
// rest and the image file agree to the bit.

#include <cstdint>
#include <span>
#include <vector>

#include "common/scene/scene.h"

namespace goldthread {

/// RGB8 of float RGBA pixels, clamped to 0 … 1 and rounded; encoded to sRGB if they are linear.
/// `rgb` holds 3 bytes for each 4 floats.
void display_rgb8(std::span<const float> rgba, ColorSpace color_space, std::span<std::uint8_t> rgb);
/// The same, in memory of its own.
std::vector<std::uint8_t> display_rgb8(std::span<const float> rgba, ColorSpace color_space);

}  // namespace goldthread
