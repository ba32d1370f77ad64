// SPDX-License-Identifier: Apache-2.0
#include "common/tile/update_pattern.h"

#include <algorithm>
#include <cmath>

namespace goldthread {
namespace {

/// Numbers of one sequence for all machines: PCG's output of a linear congruential generator
/// (O'Neill 2014).
class Sequence {
 public:
  std::uint32_t next() {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    const auto shifted = static_cast<std::uint32_t>(((state_ >> 18U) ^ state_) >> 27U);
    const auto turn = static_cast<std::uint32_t>(state_ >> 59U);
    return (shifted >> turn) | (shifted << ((32U - turn) & 31U));
  }
  /// From 0 up to, not including, a block's edge; exact in a float.
  float in_block() { return static_cast<float>(next() >> 12U) * (kFramelessBlock / 1048576.0F); }

 private:
  std::uint64_t state_ = 0x853c49e6748fea9bU;
};

/// On a torus, since the same block lies on all sides.
float squared_distance(PixelPosition a, PixelPosition b) {
  const auto apart = [](float s, float t) {
    const float d = std::abs(s - t);
    return std::min(d, kFramelessBlock - d);
  };
  const float x = apart(a.x, b.x), y = apart(a.y, b.y);
  return x * x + y * y;
}

std::vector<PixelPosition> best_candidates() {
  constexpr std::uint32_t kCandidates = 64;
  Sequence sequence;
  std::vector<PixelPosition> chosen;
  while (chosen.size() < kFramelessSamples) {
    PixelPosition best;
    float farthest = -1;
    for (std::uint32_t i = 0; i < kCandidates * (chosen.size() + 1); ++i) {
      PixelPosition candidate;
      candidate.x = sequence.in_block();
      candidate.y = sequence.in_block();
      float nearest = kFramelessBlock * kFramelessBlock;
      for (const PixelPosition other : chosen)
        nearest = std::min(nearest, squared_distance(candidate, other));
      if (nearest > farthest) best = candidate, farthest = nearest;
    }
    chosen.push_back(best);
  }
  return chosen;
}

/// Which sample of the pattern a block casts first; x and y are blocks of the image.
std::uint32_t first_sample(int x, int y) {
  auto hash =
      static_cast<std::uint32_t>(x) * 0x9e3779b1U ^ static_cast<std::uint32_t>(y) * 0x85ebca77U;
  hash ^= hash >> 15U;
  hash *= 0x2c1b3c6dU;
  hash ^= hash >> 13U;
  return hash % kFramelessSamples;
}

std::uint32_t part_of_pixel(int x, int y, Update update) {
  if (update == Update::kHalf) return static_cast<std::uint32_t>(x + y) % 2;
  if (update != Update::kQuarter) return 0;
  constexpr std::uint32_t kParts[2][2] = {{0, 2}, {3, 1}};
  return kParts[y % 2][x % 2];
}

/// Calls visit(x, y) for each cell of a rectangle that begins at 0, in blocks.
template <class Visit>
void in_blocks(int width, int height, int block_width, int block_height, Visit visit) {
  for (int v = 0; v < height; v += block_height)
    for (int u = 0; u < width; u += block_width)
      for (int y = v; y < std::min(v + block_height, height); ++y)
        for (int x = u; x < std::min(u + block_width, width); ++x) visit(x, y);
}

std::vector<UpdatePlace> pixels_of(const PixelRect& rect, Update update, std::uint32_t part) {
  std::vector<UpdatePlace> places;
  // As many pixels of a part as a packet has rays: 16.
  const int block_width = parts_of(update) == 1 ? 4 : 8;
  const int block_height = update == Update::kQuarter ? 8 : 4;
  in_blocks(rect.width, rect.height, block_width, block_height, [&](int x, int y) {
    if (part_of_pixel(rect.x + x, rect.y + y, update) != part) return;
    places.push_back(
        {static_cast<std::uint32_t>(y * rect.width + x),
         {static_cast<float>(rect.x + x) + 0.5F, static_cast<float>(rect.y + y) + 0.5F}});
  });
  return places;
}

std::vector<UpdatePlace> block_samples_of(const PixelRect& rect, std::uint32_t part) {
  std::vector<UpdatePlace> places;
  const auto& pattern = frameless_pattern();
  const int across = blocks_across(rect.width);
  in_blocks(across, blocks_across(rect.height), 4, 4, [&](int x, int y) {
    const int first_x = rect.x / kFramelessBlock + x, first_y = rect.y / kFramelessBlock + y;
    const std::uint32_t number = (first_sample(first_x, first_y) + part) % kFramelessSamples;
    const auto block = static_cast<std::uint32_t>(y * across + x);
    places.push_back({block * kFramelessSamples + number,
                      {static_cast<float>(rect.x + kFramelessBlock * x) + pattern[number].x,
                       static_cast<float>(rect.y + kFramelessBlock * y) + pattern[number].y}});
  });
  return places;
}

}  // namespace

std::uint32_t parts_of(Update update) {
  switch (update) {
    case Update::kAll:
    case Update::kWhole:
      return 1;
    case Update::kHalf:
      return 2;
    case Update::kQuarter:
      return 4;
    case Update::kFrameless:
      return kFramelessSamples;
  }
  return 1;
}

const std::vector<PixelPosition>& frameless_pattern() {
  static const std::vector<PixelPosition> pattern = best_candidates();
  return pattern;
}

std::uint32_t update_places(const PixelRect& rect, Update update) {
  if (update != Update::kFrameless) return static_cast<std::uint32_t>(rect.width * rect.height);
  return static_cast<std::uint32_t>(blocks_across(rect.width) * blocks_across(rect.height)) *
         kFramelessSamples;
}

std::vector<UpdatePlace> places_of(const PixelRect& rect, Update update, std::uint32_t part) {
  return update == Update::kFrameless ? block_samples_of(rect, part)
                                      : pixels_of(rect, update, part);
}

std::uint32_t part_of(const PixelRect& rect, Update update, std::uint32_t index) {
  if (update != Update::kFrameless) {
    const auto i = static_cast<int>(index);
    return part_of_pixel(rect.x + i % rect.width, rect.y + i / rect.width, update);
  }
  const auto block = static_cast<int>(index / kFramelessSamples);
  const int across = blocks_across(rect.width);
  const std::uint32_t first = first_sample(rect.x / kFramelessBlock + block % across,
                                           rect.y / kFramelessBlock + block / across);
  return (index % kFramelessSamples + kFramelessSamples - first) % kFramelessSamples;
}

}  // namespace goldthread
