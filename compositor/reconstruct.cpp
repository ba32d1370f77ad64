// SPDX-License-Identifier: Apache-2.0
#include "compositor/reconstruct.h"

#include <array>

namespace goldthread {
namespace {

using Color = std::array<float, 4>;

Color color_of(const Sample& s) { return {s.red, s.green, s.blue, s.alpha}; }

/// a where t is 0, to the bit.
Color lerp(const Color& a, const Color& b, float t) {
  Color result{};
  for (std::size_t c = 0; c < 4; ++c) result[c] = a[c] + t * (b[c] - a[c]);
  return result;
}

void over(const Color& color, const Color& background, float* pixel) {
  const float clear = 1 - color[3];
  for (std::size_t c = 0; c < 4; ++c) pixel[c] = color[c] + clear * background[c];
  pixel[3] = color[3];
}

/// One row of a tile at a spacing above a pixel: `above` and `below` are the rows of samples around
/// it, `down` how far it lies between them.
void interpolate_row(const Sample* above, const Sample* below, float down, int width, int spacing,
                     const Color& background, float* pixels) {
  for (int x0 = 0; x0 < width; x0 += spacing) {
    const Color left = lerp(color_of(above[x0]), color_of(below[x0]), down);
    const Color right = lerp(color_of(above[x0 + spacing]), color_of(below[x0 + spacing]), down);
    const int count = std::min(spacing, width - x0);
    for (int i = 0; i < count; ++i) {
      const float t = static_cast<float>(i) / static_cast<float>(spacing);
      over(lerp(left, right, t), background, pixels + 4 * (x0 + i));
    }
  }
}

void reconstruct_tile(const TileSamples& tile, const Color& background, int band_top,
                      int image_width, std::vector<float>& pixels) {
  const PixelRect& rect = tile.rect();
  const auto level = tile.level();
  const int spacing = level ? level->spacing_px() : 0;
  for (int y = 0; y < rect.height; ++y) {
    const auto first =
        std::size_t(rect.y - band_top + y) * std::size_t(image_width) + std::size_t(rect.x);
    float* out = pixels.data() + 4 * first;
    if (spacing > 1) {
      const int y0 = y / spacing * spacing;
      const float down = static_cast<float>(y - y0) / static_cast<float>(spacing);
      interpolate_row(tile.row(y0), tile.row(y0 + spacing), down, rect.width, spacing, background,
                      out);
      continue;
    }
    const Sample* row = tile.row(y);
    for (int x = 0; x < rect.width; ++x) {
      over(spacing == 1 ? color_of(row[x]) : Color{}, background, out + 4 * x);
    }
  }
}

struct ErrorSum {
  double squares = 0;
  std::size_t count = 0;

  void add(const Sample& before, const Sample& at, const Sample& after) {
    const auto square = [](float a, float b, float c) {
      const double half = 0.5 * (double(b) - 0.5 * (double(a) + double(c)));
      return half * half;
    };
    squares +=
        (square(before.red, at.red, after.red) + square(before.green, at.green, after.green) +
         square(before.blue, at.blue, after.blue)) /
        3;
    ++count;
  }
};

/// The last sample along an axis: of the last pixel, or replicated at or beyond the tile's edge.
int last_sample(int extent, int spacing) {
  return spacing == 1 ? extent - 1 : (extent + spacing - 1) / spacing * spacing;
}

/// The replicated samples are used as neighbours, so that a tile of two spacings has an estimate.
void add_errors(const TileSamples& tile, ErrorSum& sum) {
  const auto level = tile.level();
  if (!level) return;
  const int spacing = level->spacing_px();
  const PixelRect& rect = tile.rect();
  const int last_x = last_sample(rect.width, spacing);
  const int last_y = last_sample(rect.height, spacing);
  for (int y = 0; y < rect.height; y += spacing) {
    for (int x = spacing; x + spacing <= last_x; x += 2 * spacing) {
      sum.add(tile.at(x - spacing, y), tile.at(x, y), tile.at(x + spacing, y));
    }
  }
  for (int y = spacing; y + spacing <= last_y; y += 2 * spacing) {
    for (int x = 0; x < rect.width; x += spacing) {
      sum.add(tile.at(x, y - spacing), tile.at(x, y), tile.at(x, y + spacing));
    }
  }
}

}  // namespace

std::vector<float> reconstruct(const SampleArray& samples, const glm::dvec3& background) {
  const PixelRect band = samples.rect();
  std::vector<float> pixels(4 * std::size_t(band.width) * std::size_t(band.height));
  const Color behind{static_cast<float>(background.r), static_cast<float>(background.g),
                     static_cast<float>(background.b), 0};
  for (const TileSamples& tile : samples.tiles()) {
    reconstruct_tile(tile, behind, band.y, band.width, pixels);
  }
  return pixels;
}

double estimate_squared_error(const SampleArray& samples) {
  ErrorSum sum;
  for (const TileSamples& tile : samples.tiles()) add_errors(tile, sum);
  return sum.count > 0 ? sum.squares / static_cast<double>(sum.count) : 0;
}

}  // namespace goldthread
