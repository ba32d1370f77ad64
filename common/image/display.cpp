// SPDX-License-Identifier: Apache-2.0
#include "common/image/display.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "common/base/lanes.h"
#include "common/image/color.h"

namespace goldthread {
namespace {

/// To 0 … 1; what is not a number becomes 0.
Lanes clamped(const float* pixel) {
  constexpr Lanes kNone{}, kAll{1, 1, 1, 1};
  const Lanes value = load_lanes(pixel);
  const Lanes positive = value > kNone ? value : kNone;
  return positive < kAll ? positive : kAll;
}

/// As to_8_bits(), of all channels of a pixel.
struct Rounding {
  LaneInts operator()(Lanes value) const {
    const Lanes scaled = value * 255.0f;
    const LaneInts below = __builtin_convertvector(scaled, LaneInts);
    // Exact: adding a half before cutting off would round some values below it upwards.
    return below - (scaled - __builtin_convertvector(below, Lanes) >= 0.5f);
  }
};

/// sRGB's curve and the rounding to 8 bits, of all floats from 0 to 1, by the thresholds between
/// the 256 levels. They are found by asking the curve itself, so that the results are the same.
class SrgbLevels {
 public:
  SrgbLevels() {
    for (unsigned level = 1; level < 256; ++level) thresholds_[level] = first_of(level);
    thresholds_[256] = 2;  // beyond all
    unsigned level = 0;
    for (std::uint32_t i = 0; i < start_.size(); ++i) {
      const float low = std::bit_cast<float>(i << kDropped);
      while (low >= thresholds_[level + 1]) ++level;
      start_[i] = static_cast<std::uint8_t>(level);
    }
  }

  LaneInts operator()(Lanes value) const {
    return LaneInts{of(value[0]), of(value[1]), of(value[2]), 0};
  }

 private:
  /// Positive floats are ordered as their bits are: exponent and some of the mantissa, so much that
  /// there is no second threshold between one such place and the next.
  static constexpr unsigned kDropped = 16;
  static constexpr std::uint32_t kOne = std::bit_cast<std::uint32_t>(1.0f);

  std::int32_t of(float value) const {
    const unsigned level = start_[std::bit_cast<std::uint32_t>(value) >> kDropped];
    return static_cast<std::int32_t>(level + (value >= thresholds_[level + 1] ? 1 : 0));
  }

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

  std::array<float, 257> thresholds_{};  ///< the first is not used
  std::array<std::uint8_t, (kOne >> kDropped) + 1> start_{};
};

/// Pixels at a time: they stay in the nearest cache from level to byte.
constexpr std::size_t kChunk = 16;

/// The bytes of `count` pixels; `levels_of` gives a pixel's levels.
template <typename Levels>
void display(const float* rgba, std::size_t count, const Levels& levels_of, std::uint8_t* rgb) {
  std::array<std::int32_t, 4 * kChunk> levels{};
  for (std::size_t i = 0; i < count; ++i) {
    const LaneInts pixel = levels_of(clamped(rgba + 4 * i));
    std::memcpy(&levels[4 * i], &pixel, sizeof pixel);
  }
  std::array<std::uint8_t, 4 * kChunk> bytes;
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(levels[i]);
  // Four bytes at a time: the last is that of the next pixel, which is written after it.
  for (std::size_t i = 0; i + 1 < count; ++i) std::memcpy(rgb + 3 * i, &bytes[4 * i], 4);
  std::memcpy(rgb + 3 * (count - 1), &bytes[4 * (count - 1)], 3);
}

template <typename Levels>
void display_all(std::span<const float> rgba, const Levels& levels_of, std::uint8_t* rgb) {
  const std::size_t pixels = rgba.size() / 4;
  std::size_t first = 0;
  for (; first + kChunk <= pixels; first += kChunk)
    display(rgba.data() + 4 * first, kChunk, levels_of, rgb + 3 * first);
  if (first < pixels) display(rgba.data() + 4 * first, pixels - first, levels_of, rgb + 3 * first);
}

}  // namespace

void display_rgb8(std::span<const float> rgba, ColorSpace color_space,
                  std::span<std::uint8_t> rgb) {
  if (color_space == ColorSpace::kLinear) {
    static const SrgbLevels srgb;
    display_all(rgba, srgb, rgb.data());
  } else {
    display_all(rgba, Rounding{}, rgb.data());
  }
}

std::vector<std::uint8_t> display_rgb8(std::span<const float> rgba, ColorSpace color_space) {
  std::vector<std::uint8_t> rgb(3 * (rgba.size() / 4));
  display_rgb8(rgba, color_space, rgb);
  return rgb;
}

}  // namespace goldthread
