// SPDX-License-Identifier: Apache-2.0
#include "compositor/reconstruct.h"

#include <cstdint>
#include <cstring>

#include "common/base/lanes.h"
#include "common/image/display.h"
#include "common/tile/fill_holes.h"

namespace goldthread {
namespace {

constexpr LaneInts kColors{-1, -1, -1, 0};

/// Puts a row of samples over the background.
void over(std::span<const Sample> row, const Lanes& behind, float* pixels) {
  for (const Sample& sample : row) {
    const Lanes color = load_lanes(&sample);
    store_lanes(pixels, kColors ? color + (1 - sample.alpha) * behind : color);
    pixels += 4;
  }
}

Lanes lanes_of(const glm::dvec3& background) {
  return Lanes{static_cast<float>(background.r), static_cast<float>(background.g),
               static_cast<float>(background.b), 0};
}

/// Where not even the coarsest samples are there, nothing can be filled in: what is in the places
/// may be of another view.
void empty_holes(std::span<Sample> samples, std::span<const std::uint8_t> known) {
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (!known[i]) samples[i] = {};
}

/// A tile's samples without holes: its own, or filled in in `memory`.
std::span<const Sample> without_holes(const TileSamples& tile, Filter filter,
                                      std::vector<Sample>& memory) {
  const std::span known = tile.known();
  if (std::memchr(known.data(), 0, known.size()) == nullptr) return tile.samples();
  memory.assign(tile.samples().begin(), tile.samples().end());
  if (known[0])
    fill_holes({tile.stride(), tile.rows(), memory, known}, filter);
  else
    empty_holes(memory, known);
  return memory;
}

std::span<const Sample> row_of(std::span<const Sample> samples, int stride, int y, int width) {
  return samples.subspan(std::size_t(y) * std::size_t(stride), std::size_t(width));
}

/// A tile's row among the pixels of a band.
std::size_t first_pixel(const PixelRect& rect, int y, const PixelRect& band) {
  return std::size_t(rect.y - band.y + y) * std::size_t(band.width) + std::size_t(rect.x - band.x);
}

}  // namespace

void write_over(std::span<const Sample> samples, int stride, const PixelRect& rect,
                const glm::dvec3& background, const PixelRect& band, std::span<float> pixels) {
  const Lanes behind = lanes_of(background);
  for (int y = 0; y < rect.height; ++y)
    over(row_of(samples, stride, y, rect.width), behind,
         pixels.data() + 4 * first_pixel(rect, y, band));
}

void write_shown(std::span<const Sample> samples, int stride, const PixelRect& rect,
                 const glm::dvec3& background, const PixelRect& band, ColorSpace color_space,
                 std::span<std::uint8_t> rgb) {
  const Lanes behind = lanes_of(background);
  const auto width = std::size_t(rect.width);
  std::vector<float> row(4 * width);
  for (int y = 0; y < rect.height; ++y) {
    over(row_of(samples, stride, y, rect.width), behind, row.data());
    display_rgb8(row, color_space, rgb.subspan(3 * first_pixel(rect, y, band), 3 * width));
  }
}

std::vector<float> reconstruct(const SampleArray& samples, Filter filter,
                               const glm::dvec3& background) {
  const PixelRect band = samples.rect();
  std::vector<float> pixels(4 * std::size_t(band.width) * std::size_t(band.height));
  std::vector<Sample> memory;
  for (const TileSamples& tile : samples.tiles())
    write_over(without_holes(tile, filter, memory), tile.stride(), tile.rect(), background, band,
               pixels);
  return pixels;
}

void reconstruct_shown(const SampleArray& samples, Filter filter, const glm::dvec3& background,
                       ColorSpace color_space, std::vector<std::uint8_t>& rgb) {
  const PixelRect band = samples.rect();
  rgb.resize(3 * std::size_t(band.width) * std::size_t(band.height));
  std::vector<Sample> memory;
  for (const TileSamples& tile : samples.tiles())
    write_shown(without_holes(tile, filter, memory), tile.stride(), tile.rect(), background, band,
                color_space, rgb);
}

}  // namespace goldthread
