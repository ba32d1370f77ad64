// SPDX-License-Identifier: Apache-2.0
#pragma once
// Colours as displayed, over the background, in 0 … 1: differences and errors are judged as users
// see them. Each is one register of four lanes, which every x86-64 and ARMv8 has.

#include <array>
#include <cstdint>
#include <cstring>

namespace goldthread {

using ShownLanes = float __attribute__((vector_size(16)));
using ShownBits = std::int32_t __attribute__((vector_size(16)));

/// Red, green and blue; the fourth number is 0.
struct alignas(16) Shown {
  std::array<float, 4> value{};

  ShownLanes lanes() const {
    ShownLanes lanes;
    std::memcpy(&lanes, value.data(), sizeof lanes);
    return lanes;
  }
  static Shown of(ShownLanes lanes) {
    Shown shown;
    std::memcpy(shown.value.data(), &lanes, sizeof lanes);
    return shown;
  }
};

inline ShownLanes greater_of(ShownLanes a, ShownLanes b) { return a > b ? a : b; }
inline ShownLanes lesser_of(ShownLanes a, ShownLanes b) { return a < b ? a : b; }
inline ShownLanes middle(ShownLanes a, ShownLanes b) { return 0.5F * (a + b); }

/// By channel.
inline ShownLanes distance(ShownLanes a, ShownLanes b) {
  constexpr std::int32_t kAllButSign = 0x7FFFFFFF;
  const ShownLanes difference = a - b;
  ShownBits bits;
  std::memcpy(&bits, &difference, sizeof bits);
  bits &= kAllButSign;
  ShownLanes distance;
  std::memcpy(&distance, &bits, sizeof distance);
  return distance;
}

/// Whether a channel is greater than `threshold`.
inline bool exceeds(ShownLanes distance, float threshold) {
  const ShownBits greater = distance > threshold;
  return (greater[0] | greater[1] | greater[2]) != 0;
}

/// The greatest channel.
inline float greatest(ShownLanes lanes) {
  const float two = lanes[0] > lanes[1] ? lanes[0] : lanes[1];
  return two > lanes[2] ? two : lanes[2];
}

/// Mean over the channels of the squared difference.
inline double squared_distance(ShownLanes a, ShownLanes b) {
  const ShownLanes difference = a - b;
  const ShownLanes square = difference * difference;
  return double(square[0] + square[1] + square[2]) / 3;
}

}  // namespace goldthread
