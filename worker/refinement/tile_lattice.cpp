// SPDX-License-Identifier: Apache-2.0
#include "worker/refinement/tile_lattice.h"

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

Appearance appearance_of(const glm::dvec3& background, ColorSpace color_space) {
  return {{{static_cast<float>(background.r), static_cast<float>(background.g),
            static_cast<float>(background.b), 0}},
          color_space};
}

Shown shown(const Sample& sample, const Appearance& appearance) {
  const ShownLanes premultiplied{sample.red, sample.green, sample.blue, 0};
  ShownLanes value = premultiplied + (1 - sample.alpha) * appearance.behind.lanes();
  if (appearance.color_space == ColorSpace::kLinear) {
    for (int c = 0; c < 3; ++c) value[c] = static_cast<float>(srgb_from_linear(double(value[c])));
  }
  const ShownLanes black{0, 0, 0, 0}, white{1, 1, 1, 1};
  return Shown::of(lesser_of(greater_of(value, black), white));
}

void TileLattice::restart(ImageSize tile, const Appearance& appearance, bool with_surfaces) {
  tile_ = tile;
  columns_ = places_along(tile.width);
  rows_ = places_along(tile.height);
  appearance_ = appearance;
  std::size_t places = 0;
  for (std::size_t level = levels_.size(); level-- > 0;) {
    levels_[level] = {places, static_cast<std::size_t>((columns_ - 1) >> level) + 1};
    places += levels_[level].columns * (static_cast<std::size_t>((rows_ - 1) >> level) + 1);
  }
  if (places > room_) {
    samples_ = std::make_unique_for_overwrite<Sample[]>(places);
    shown_ = std::make_unique_for_overwrite<Shown[]>(places);
    room_ = places;
  }
  state_.assign(places, 0);
  surfaces_.resize(with_surfaces ? places : 0);
  current_ = 1;
}

void TileLattice::put(int x, int y, const Sample& sample, std::uint32_t surfaces) {
  const std::size_t i = index(x, y);
  samples_[i] = sample;
  shown_[i] = shown(sample, appearance_);
  state_[i] = kKnown;
  if (with_surfaces()) surfaces_[i] = surfaces;
}

void TileLattice::put_mean(int x, int y, const Sample& mean, std::uint32_t surfaces) {
  put(x, y, mean, surfaces);
  state_[index(x, y)] = kSampledFurther;
}

int TileLattice::pixels_of_block(int x, int y) const {
  return std::min(kCoarsestSpacing, tile_.width - x) * std::min(kCoarsestSpacing, tile_.height - y);
}

ShownLanes TileLattice::filled_at(int x, int y) {
  const int s = spacing_of(x, y);
  const bool across = (x & s) != 0, down = (y & s) != 0;
  if (across && down)
    return middle(middle(at(x - s, y), at(x + s, y)), middle(at(x, y - s), at(x, y + s)));
  if (across) return middle(at(x - s, y), at(x + s, y));
  return middle(at(x, y - s), at(x, y + s));
}

std::uint32_t TileLattice::surfaces_at(int x, int y) {
  while (!known(x, y)) {
    const int s = spacing_of(x, y);
    if ((x & s) != 0) x -= s;
    if ((y & s) != 0) y -= s;
  }
  return surfaces_[index(x, y)];
}

void TileLattice::forget_filled() {
  if (++current_ < kWanted) return;
  std::replace_if(
      state_.begin(), state_.end(), [](std::uint8_t state) { return state < kKnown; },
      std::uint8_t{0});
  current_ = 1;
}

}  // namespace goldthread
