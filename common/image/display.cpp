// SPDX-License-Identifier: Apache-2.0
#include "common/image/display.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "common/image/color.h"

namespace goldthread {
namespace {

/// As to_8_bits(), without a branch or a call, so that the compiler takes many at once.
std::uint8_t rounded(float value) {
  const float positive = value > 0 ? value : 0;  // what is not a number becomes 0
  const float scaled = (positive < 1 ? positive : 1) * 255;
  const int below = static_cast<int>(scaled);
  // Exact: adding a half before cutting off would round some values below it upwards.
  const bool up = scaled - static_cast<float>(below) >= 0.5f;
  return static_cast<std::uint8_t>(below + (up ? 1 : 0));
}

/// Pixels at a time: they stay in the nearest cache between rounding and packing.
constexpr std::size_t kChunk = 64;

void display(std::span<const float> rgba, std::uint8_t* rgb) {
  const std::size_t pixels = rgba.size() / 4;
  for (std::size_t first = 0; first < pixels; first += kChunk) {
    const std::size_t count = std::min(kChunk, pixels - first);
    std::array<std::uint8_t, 4 * kChunk> bytes;
    for (std::size_t i = 0; i < 4 * count; ++i) bytes[i] = rounded(rgba[4 * first + i]);
    std::uint8_t* out = rgb + 3 * first;
    // Four bytes at a time: the last is that of the next pixel, which is written after it.
    for (std::size_t i = 0; i + 1 < count; ++i) std::memcpy(out + 3 * i, &bytes[4 * i], 4);
    std::memcpy(out + 3 * (count - 1), &bytes[4 * (count - 1)], 3);
  }
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
