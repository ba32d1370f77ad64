// SPDX-License-Identifier: Apache-2.0
#include "bench/error/adaptive_caster.h"

#include <algorithm>
#include <numeric>

#include "common/tile/fill_holes.h"

namespace goldthread::bench {
namespace {

Sample over(const Sample& sample, const Sample& behind) {
  const float clear = 1 - sample.alpha;
  return {sample.red + clear * behind.red, sample.green + clear * behind.green,
          sample.blue + clear * behind.blue, sample.alpha};
}

}  // namespace

AdaptiveCaster::AdaptiveCaster(ImageSize size, int threads, int tile_px)
    : grid_(TileGrid::squares(size, tile_px)),
      tiles_(grid_.count()),
      order_(grid_.count()),
      pixels_(std::size_t(size.width) * std::size_t(size.height)),
      crew_(threads) {
  for (std::uint32_t id = 0; id < grid_.count(); ++id) {
    Tile& tile = tiles_[id];
    tile.rect = grid_.rect({id});
    tile.stride = places_along(tile.rect.width);
    const auto places = std::size_t(tile.stride) * std::size_t(places_along(tile.rect.height));
    tile.samples.resize(places);
    tile.known.resize(places);
  }
  std::iota(order_.begin(), order_.end(), std::size_t{0});
}

void AdaptiveCaster::restart(Tile& tile, const TileTask& task) {
  if (tile.refinement)
    tile.refinement->restart(task);
  else
    tile.refinement = std::make_unique<TileRefinement>(task);
  std::fill(tile.known.begin(), tile.known.end(), std::uint8_t{0});
  tile.rays = 0;
}

void AdaptiveCaster::advance(Tile& tile, const SampleSource& source) {
  const std::uint64_t before = tile.rays;
  tile.refinement->advance([&](std::span<const PixelPosition> positions, std::span<Sample> samples,
                               std::span<std::uint32_t> surfaces) {
    source.cast(positions, samples, surfaces);
    tile.rays += positions.size();
    return true;
  });
  tile.last_rays = tile.rays - before;
  for (const SampleOffset place : tile.refinement->changed()) {
    const std::size_t i = std::size_t(place.y) * std::size_t(tile.stride) + place.x;
    tile.samples[i] = tile.refinement->sample(place);
    tile.known[i] = 1;
  }
}

void AdaptiveCaster::reconstruct(Tile& tile, const Sample& behind) {
  const int rows = places_along(tile.rect.height);
  fill_holes({tile.stride, rows, tile.samples, tile.known}, Filter::kBilinear);
  for (int y = 0; y < tile.rect.height; ++y) {
    const Sample* row = tile.samples.data() + std::size_t(y) * std::size_t(tile.stride);
    Sample* out = pixels_.data() + std::size_t(tile.rect.y + y) * std::size_t(grid_.image.width) +
                  tile.rect.x;
    for (int x = 0; x < tile.rect.width; ++x) out[x] = over(row[x], behind);
  }
}

Refined AdaptiveCaster::sum(Step step) const {
  Refined total{step, {}, 0};
  for (const Tile& tile : tiles_) {
    total.quality.squared_error += tile.refinement->quality().squared_error;
    total.rays += tile.rays;
  }
  return total;
}

void AdaptiveCaster::sort_by_rays() {
  std::sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
    return tiles_[a].last_rays > tiles_[b].last_rays;
  });
}

Refined AdaptiveCaster::cast(const SampleSource& source, const ImageSettings& image,
                             const Refinement& how, const Enough& enough) {
  const TileTask task{
      {}, how, appearance_of(image.background, image.color_space), source.has_surfaces()};
  Refined result;
  while (result.step == kNoStep || !enough(result)) {
    const bool first = result.step == kNoStep;
    crew_.share(tiles_.size(), [&](std::size_t i) {
      Tile& tile = tiles_[order_[i]];
      if (first) {
        TileTask own = task;
        own.rect = tile.rect;
        restart(tile, own);
      }
      advance(tile, source);
    });
    result = sum(result.step.next());
    sort_by_rays();
  }
  const glm::vec3 background(image.background);
  const Sample behind{background.r, background.g, background.b, 0};
  crew_.share(tiles_.size(), [&](std::size_t i) { reconstruct(tiles_[i], behind); });
  return result;
}

std::vector<Color> AdaptiveCaster::shown(const ImageSettings& image, int stride) const {
  std::vector<Color> colors;
  for (int y = 0; y < grid_.image.height; y += stride)
    for (int x = 0; x < grid_.image.width; x += stride) {
      const Sample& pixel =
          pixels_[std::size_t(y) * std::size_t(grid_.image.width) + std::size_t(x)];
      colors.push_back(displayed({pixel.red, pixel.green, pixel.blue}, 1, image.background,
                                 image.color_space == ColorSpace::kLinear));
    }
  return colors;
}

}  // namespace goldthread::bench
