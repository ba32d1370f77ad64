// SPDX-License-Identifier: Apache-2.0
#include "bench/motion/refined_view.h"

#include <algorithm>

#include "common/tile/tile_grid.h"

namespace goldthread::bench {
namespace {

constexpr int kTile = 64;

}  // namespace

RefinedView::RefinedView(const MotionScene& scene, const Camera& camera, double input_seconds)
    : scene_(scene), camera_(camera), input_seconds_(input_seconds), rays_(scene, camera) {
  const TileGrid grid = TileGrid::squares(scene.image.size, kTile);
  for (std::uint32_t id = 0; id < grid.count(); ++id)
    tiles_.push_back(tile_of(grid.rect({id}), rays_.has_surfaces()));
}

RefinedView::Tile RefinedView::tile_of(const PixelRect& rect, bool with_surfaces) const {
  const int stride = places_along(rect.width), rows = places_along(rect.height);
  const auto places = static_cast<std::size_t>(stride * rows);
  const Appearance appearance = appearance_of(scene_.image.background, scene_.image.color_space);
  return {rect,
          TileRefinement({rect, Refinement{}, appearance, with_surfaces}),
          stride,
          rows,
          std::vector<Sample>(places),
          std::vector<std::uint8_t>(places)};
}

double RefinedView::advance() {
  Tile& tile = tiles_[next_];
  const double seconds = thread_seconds_of([&] {
    tile.refinement.advance([&](std::span<const PixelPosition> positions, std::span<Sample> samples,
                                std::span<std::uint32_t> surfaces) {
      rays_.cast(positions, samples, surfaces);
      return true;
    });
    for (const SampleOffset place : tile.refinement.changed()) {
      const auto index = std::size_t(place.y) * std::size_t(tile.stride) + place.x;
      tile.samples[index] = tile.refinement.sample(place);
      tile.known[index] = 1;
    }
  });
  if (++next_ == tiles_.size()) {
    next_ = 0;
    step_ = step_.next();
  }
  return scene_.shared(seconds);
}

TileQuality RefinedView::quality() const {
  TileQuality sum;
  for (const Tile& tile : tiles_) {
    sum.squared_error += tile.refinement.quality().squared_error;
    sum.squared_gradient += tile.refinement.quality().squared_gradient;
  }
  return sum;
}

ShownPicture RefinedView::picture(double& seconds) {
  const auto width = static_cast<std::size_t>(scene_.image.size.width);
  std::vector<Sample> pixels(width * static_cast<std::size_t>(scene_.image.size.height));
  seconds += scene_.alone(thread_seconds_of([&] {
    for (Tile& tile : tiles_) {
      fill_holes({tile.stride, tile.rows, tile.samples, tile.known}, Filter::kBilinear);
      for (int y = 0; y < tile.rect.height; ++y)
        std::copy_n(
            tile.samples.begin() + std::ptrdiff_t(y) * tile.stride, tile.rect.width,
            pixels.begin() + std::ptrdiff_t(tile.rect.y + y) * std::ptrdiff_t(width) + tile.rect.x);
    }
  }));
  return shown_picture(pixels, scene_.image, input_seconds_);
}

}  // namespace goldthread::bench
