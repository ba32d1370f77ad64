// SPDX-License-Identifier: Apache-2.0
#pragma once
// sRGB's transfer curve, exactly as IEC 61966-2-1 has it, and rounding to 8 bits.

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace goldthread {

/// Linear light in [0, 1] to the displayed value in [0, 1]; also usable a little outside.
inline double srgb_from_linear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

/// The displayed value in [0, 1] to linear light.
inline double linear_from_srgb(double displayed) {
  return displayed <= 0.04045 ? displayed / 12.92 : std::pow((displayed + 0.055) / 1.055, 2.4);
}

/// The nearest of the 256 levels; outside [0, 1] the end, NaN 0.
inline std::uint8_t to_8_bits(double value) {
  if (!(value > 0)) return 0;
  return static_cast<std::uint8_t>(std::lround(std::min(value, 1.0) * 255));
}

}  // namespace goldthread
