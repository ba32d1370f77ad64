// SPDX-License-Identifier: Apache-2.0
#include "bench/error/frame.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include "bench/reference/reference_integrator.h"
#include "common/tile/tile_grid.h"

namespace goldthread::bench {
namespace {

constexpr int kTile = 64;

}  // namespace

void in_parallel(int threads, std::size_t count, const std::function<void(std::size_t)>& work,
                 const std::function<void(double)>& progress) {
  std::atomic<std::size_t> next{0};
  const auto take = [&] {
    for (std::size_t i; (i = next.fetch_add(1)) < count;) work(i);
  };
  std::vector<std::jthread> pool;
  for (int i = 1; i < threads; ++i) pool.emplace_back(take);
  for (std::size_t i; (i = next.fetch_add(1)) < count;) {
    progress(double(i) / double(count));
    work(i);
  }
}

FrameCaster::FrameCaster(ImageSize size, int threads) : size_(size), threads_(threads) {
  const TileGrid grid = TileGrid::squares(size, kTile);
  for (std::uint32_t id = 0; id < grid.count(); ++id) {
    const PixelRect rect = grid.rect({id});
    for (const SampleOffset offset : grid_places({rect.width, rect.height}, 1))
      positions_.push_back(position_of(rect, offset));
    tile_ends_.push_back(positions_.size());
  }
  samples_.resize(positions_.size());
}

CastCounts FrameCaster::cast(const SampleSource& source) {
  std::vector<CastCounts> counts(tile_ends_.size());
  in_parallel(threads_, tile_ends_.size(), [&](std::size_t tile) {
    const std::size_t begin = tile == 0 ? 0 : tile_ends_[tile - 1];
    const std::size_t count = tile_ends_[tile] - begin;
    counts[tile] = source.cast(std::span(positions_).subspan(begin, count),
                               std::span(samples_).subspan(begin, count));
  });
  CastCounts total;
  for (const CastCounts& tile : counts) total += tile;
  return total;
}

std::vector<Color> FrameCaster::shown(const ImageSettings& image, int stride) const {
  const auto columns = std::size_t((size_.width + stride - 1) / stride);
  std::vector<Color> colors(Subset{size_, stride}.count());
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    const int x = static_cast<int>(positions_[i].x), y = static_cast<int>(positions_[i].y);
    if (x % stride != 0 || y % stride != 0) continue;
    colors[std::size_t(y / stride) * columns + std::size_t(x / stride)] =
        displayed(samples_[i], image.background, image.color_space == ColorSpace::kLinear);
  }
  return colors;
}

std::size_t Subset::count() const {
  return std::size_t((image.width + stride - 1) / stride) *
         std::size_t((image.height + stride - 1) / stride);
}

PixelPosition Subset::centre(std::size_t i) const {
  const auto columns = std::size_t((image.width + stride - 1) / stride);
  const std::size_t column = i % columns, row = i / columns;
  return {float(stride) * float(column) + 0.5F, float(stride) * float(row) + 0.5F};
}

std::vector<Color> reference_picture(const ReferenceRequest& request) {
  const ImageSettings& image = request.scene.image;
  const reference::Integrator integrator(request.scene, request.geometry,
                                         {request.voxels.begin(), request.voxels.end()},
                                         request.substeps);
  std::vector<Color> colors(request.subset.count());
  in_parallel(
      request.threads, colors.size(),
      [&](std::size_t i) {
        const PixelPosition centre = request.subset.centre(i);
        const auto radiance =
            integrator.cast(double(centre.x) + request.shift.x, double(centre.y) + request.shift.y);
        colors[i] = displayed(radiance.color, radiance.alpha, image.background,
                              image.color_space == ColorSpace::kLinear);
      },
      request.progress);
  return colors;
}

}  // namespace goldthread::bench
