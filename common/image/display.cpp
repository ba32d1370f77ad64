// SPDX-License-Identifier: Apache-2.0
#include "common/image/display.h"

#include <algorithm>
#include <cmath>

#include "common/image/color.h"

namespace goldthread {

std::vector<std::uint8_t> display_rgb8(std::span<const float> rgba, ColorSpace color_space) {
  const std::size_t pixels = rgba.size() / 4;
  std::vector<std::uint8_t> rgb(3 * pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = rgba[4 * i + c];
      if (color_space == ColorSpace::kLinear) {
        rgb[3 * i + c] = to_8_bits(srgb_from_linear(value));
      } else {
        // Ordered so that NaN becomes 0.
        const float clamped = std::min(std::max(0.0f, value), 1.0f);
        rgb[3 * i + c] = static_cast<std::uint8_t>(std::lround(clamped * 255));
      }
    }
  }
  return rgb;
}

}  // namespace goldthread
