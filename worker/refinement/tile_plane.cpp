// SPDX-License-Identifier: Apache-2.0
#include "worker/refinement/tile_plane.h"

#include <algorithm>
#include <bit>

#include "common/image/color.h"

namespace goldthread {
namespace {

/// The spacing of the coarsest grid that a place belongs to.
int spacing_of(int x, int y) {
  const auto bits = static_cast<unsigned>(x | y | kCoarsestSpacing);
  return 1 << std::countr_zero(bits);
}

}  // namespace

Shown shown(const Sample& sample, const Appearance& appearance) {
  const float clear = 1 - sample.alpha;
  const std::array<float, 3> colors{sample.red, sample.green, sample.blue};
  Shown result;
  for (std::size_t c = 0; c < 3; ++c) {
    float value = colors[c] + clear * static_cast<float>(appearance.background[int(c)]);
    if (appearance.color_space == ColorSpace::kLinear)
      value = static_cast<float>(srgb_from_linear(double(value)));
    result.value[c] = std::clamp(value, 0.0F, 1.0F);
  }
  return result;
}

TilePlane::TilePlane(ImageSize tile, const Appearance& appearance, bool with_surfaces)
    : tile_(tile),
      columns_(places_along(tile.width)),
      rows_(places_along(tile.height)),
      appearance_(appearance) {
  const auto places = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  samples_.resize(places);
  shown_.resize(places);
  state_.resize(places);
  if (with_surfaces) surfaces_.resize(places);
}

void TilePlane::put(int x, int y, const Sample& sample, std::uint32_t surfaces) {
  const std::size_t i = index(x, y);
  samples_[i] = sample;
  shown_[i] = shown(sample, appearance_);
  state_[i] = kKnown;
  if (with_surfaces()) surfaces_[i] = surfaces;
}

int TilePlane::pixels_of_block(int x, int y) const {
  return std::min(kCoarsestSpacing, tile_.width - x) * std::min(kCoarsestSpacing, tile_.height - y);
}

Shown TilePlane::filled_at(int x, int y) {
  const int s = spacing_of(x, y);
  const bool across = (x & s) != 0, down = (y & s) != 0;
  if (across && down) {
    return midpoint(midpoint(at(x - s, y), at(x + s, y)), midpoint(at(x, y - s), at(x, y + s)));
  }
  if (across) return midpoint(at(x - s, y), at(x + s, y));
  return midpoint(at(x, y - s), at(x, y + s));
}

std::uint32_t TilePlane::surfaces_at(int x, int y) {
  while (!known(x, y)) {
    const int s = spacing_of(x, y);
    if ((x & s) != 0) x -= s;
    if ((y & s) != 0) y -= s;
  }
  return surfaces_[index(x, y)];
}

void TilePlane::forget_filled() {
  if (++current_ < kWanted) return;
  std::replace_if(
      state_.begin(), state_.end(), [](std::uint8_t state) { return state != kKnown; },
      std::uint8_t{0});
  current_ = 1;
}

}  // namespace goldthread
