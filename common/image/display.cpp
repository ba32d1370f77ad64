// SPDX-License-Identifier: Apache-2.0
#include "common/image/display.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "common/image/color.h"

namespace goldthread {
namespace {

/// A pixel in one register of every x86-64 and ARMv8.
using Lanes = float __attribute__((vector_size(16)));
using Integers = std::int32_t __attribute__((vector_size(16)));
using Bytes = std::uint8_t __attribute__((vector_size(4)));

/// As to_8_bits(), a whole pixel at a time.
Bytes rounded(const float* rgba) {
  Lanes value;
  std::memcpy(&value, rgba, sizeof value);
  const Lanes zero{0, 0, 0, 0}, one{1, 1, 1, 1};
  value = value > zero ? value : zero;  // what is not a number becomes 0
  value = (value < one ? value : one) * 255.0f;
  const Integers below = __builtin_convertvector(value, Integers);
  // Exact: adding a half before cutting off would round some values below it upwards.
  const Lanes rest = value - __builtin_convertvector(below, Lanes);
  const Integers up = rest >= 0.5f;  // −1 where true
  return __builtin_convertvector(below - up, Bytes);
}

void display(std::span<const float> rgba, std::uint8_t* rgb) {
  const std::size_t pixels = rgba.size() / 4;
  // Four bytes at a time: the last is that of the next pixel, which is written after it.
  for (std::size_t i = 0; i + 1 < pixels; ++i) {
    const Bytes bytes = rounded(rgba.data() + 4 * i);
    std::memcpy(rgb + 3 * i, &bytes, 4);
  }
  if (pixels == 0) return;
  const Bytes last = rounded(rgba.data() + 4 * (pixels - 1));
  std::memcpy(rgb + 3 * (pixels - 1), &last, 3);
}

/// sRGB's curve and the rounding to 8 bits, of all floats from 0 to 1, by the thresholds between
/// the 256 levels. They are found by asking the curve itself, so that the results are the same.
class SrgbLevels {
 public:
  SrgbLevels() {
    for (unsigned level = 1; level < thresholds_.size(); ++level)
      thresholds_[level] = first_of(level);
    unsigned level = 0;
    for (std::uint32_t i = 0; i < start_.size(); ++i) {
      const float low = std::bit_cast<float>(i << kDropped);
      while (level < 255 && low >= thresholds_[level + 1]) ++level;
      start_[i] = static_cast<std::uint8_t>(level);
    }
  }

  std::uint8_t of(float value) const {
    if (!(value > 0)) return 0;
    if (value >= 1) return 255;
    unsigned level = start_[std::bit_cast<std::uint32_t>(value) >> kDropped];
    while (level < 255 && value >= thresholds_[level + 1]) ++level;
    return static_cast<std::uint8_t>(level);
  }

 private:
  /// Positive floats are ordered as their bits are: exponent and some of the mantissa.
  static constexpr unsigned kDropped = 16;
  static constexpr std::uint32_t kOne = std::bit_cast<std::uint32_t>(1.0f);

  /// The least float that is shown as `level`.
  static float first_of(unsigned level) {
    std::uint32_t low = 0, high = kOne;
    while (low < high) {
      const std::uint32_t middle = low + (high - low) / 2;
      if (to_8_bits(srgb_from_linear(double(std::bit_cast<float>(middle)))) >= level)
        high = middle;
      else
        low = middle + 1;
    }
    return std::bit_cast<float>(low);
  }

  std::array<float, 256> thresholds_{};  ///< the first is not used
  std::array<std::uint8_t, (kOne >> kDropped) + 1> start_{};
};

void display_linear(std::span<const float> rgba, std::uint8_t* rgb) {
  static const SrgbLevels levels;
  for (std::size_t i = 0; i < rgba.size() / 4; ++i)
    for (std::size_t c = 0; c < 3; ++c) rgb[3 * i + c] = levels.of(rgba[4 * i + c]);
}

}  // namespace

void display_rgb8(std::span<const float> rgba, ColorSpace color_space,
                  std::span<std::uint8_t> rgb) {
  if (color_space == ColorSpace::kLinear)
    display_linear(rgba, rgb.data());
  else
    display(rgba, rgb.data());
}

std::vector<std::uint8_t> display_rgb8(std::span<const float> rgba, ColorSpace color_space) {
  std::vector<std::uint8_t> rgb(3 * (rgba.size() / 4));
  display_rgb8(rgba, color_space, rgb);
  return rgb;
}

}  // namespace goldthread
