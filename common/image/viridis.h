// SPDX-License-Identifier: Apache-2.0
#pragma once
// The colour map viridis (Smith and van der Walt, 2015): equal steps of the value look equal, in
// grey and to the colour-blind too. Joined linearly between eleven of its colours.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace goldthread {

/// 8-bit sRGB of a value from 0 to 1; what is outside has the colour of the nearer end.
inline std::array<std::uint8_t, 3> viridis(double value) {
  constexpr std::array<std::array<int, 3>, 11> kColors = {{{0x44, 0x01, 0x54},
                                                           {0x48, 0x25, 0x76},
                                                           {0x41, 0x44, 0x87},
                                                           {0x35, 0x60, 0x8d},
                                                           {0x2a, 0x78, 0x8e},
                                                           {0x21, 0x90, 0x8c},
                                                           {0x22, 0xa8, 0x84},
                                                           {0x43, 0xbf, 0x71},
                                                           {0x7a, 0xd1, 0x51},
                                                           {0xbb, 0xdf, 0x27},
                                                           {0xfd, 0xe7, 0x25}}};
  const double place = std::clamp(value, 0.0, 1.0) * (kColors.size() - 1);
  const auto lower = std::min(static_cast<std::size_t>(place), kColors.size() - 2);
  const double part = place - static_cast<double>(lower);
  std::array<std::uint8_t, 3> rgb{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double mixed = (1 - part) * kColors[lower][c] + part * kColors[lower + 1][c];
    rgb[c] = static_cast<std::uint8_t>(std::lround(mixed));
  }
  return rgb;
}

}  // namespace goldthread
