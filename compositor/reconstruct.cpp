// SPDX-License-Identifier: Apache-2.0
#include "compositor/reconstruct.h"

#include <array>

#include "common/tile/fill_holes.h"

namespace goldthread {
namespace {

using Color = std::array<float, 4>;

void over(const Sample& sample, const Color& background, float* pixel) {
  const Color color{sample.red, sample.green, sample.blue, sample.alpha};
  const float clear = 1 - sample.alpha;
  for (std::size_t c = 0; c < 4; ++c) pixel[c] = color[c] + clear * background[c];
  pixel[3] = sample.alpha;
}

/// Where not even the coarsest samples are there, nothing can be filled in: what is in the places
/// may be of another view.
void empty_holes(std::span<Sample> samples, std::span<const std::uint8_t> known) {
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (!known[i]) samples[i] = {};
}

}  // namespace

void write_over(std::span<const Sample> samples, int stride, const PixelRect& rect,
                const glm::dvec3& background, const PixelRect& band, std::span<float> pixels) {
  const Color behind{static_cast<float>(background.r), static_cast<float>(background.g),
                     static_cast<float>(background.b), 0};
  for (int y = 0; y < rect.height; ++y) {
    const Sample* row = samples.data() + std::size_t(y) * std::size_t(stride);
    float* out = pixels.data() + 4 * (std::size_t(rect.y - band.y + y) * std::size_t(band.width) +
                                      std::size_t(rect.x - band.x));
    for (int x = 0; x < rect.width; ++x) over(row[x], behind, out + 4 * x);
  }
}

std::vector<float> reconstruct(const SampleArray& samples, Filter filter,
                               const glm::dvec3& background) {
  const PixelRect band = samples.rect();
  std::vector<float> pixels(4 * std::size_t(band.width) * std::size_t(band.height));
  std::vector<Sample> filled;
  for (const TileSamples& tile : samples.tiles()) {
    filled.assign(tile.samples().begin(), tile.samples().end());
    if (tile.known()[0])
      fill_holes({tile.stride(), tile.rows(), filled, tile.known()}, filter);
    else
      empty_holes(filled, tile.known());
    write_over(filled, tile.stride(), tile.rect(), background, band, pixels);
  }
  return pixels;
}

}  // namespace goldthread
