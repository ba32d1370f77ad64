// SPDX-License-Identifier: Apache-2.0
#include "master/cost_picture.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/image/viridis.h"

namespace goldthread {
namespace {

constexpr double kEdge = 0.55;  // of a tile's colour

double per_pixel(const ViewState& view, TileId id) {
  const PixelRect rect = view.grid.rect(id);
  return view.tiles[id.value].seconds / (double(rect.width) * rect.height);
}

double dearest(const ViewState& view) {
  double most = 0;
  for (std::uint32_t i = 0; i < view.grid.count(); ++i) most = std::max(most, per_pixel(view, {i}));
  return most;
}

/// Calls paint(place, x, y) for each pixel of a tile: its place in the image, and in the tile.
template <class Paint>
void each_pixel(const ViewState& view, TileId id, Paint paint) {
  const PixelRect rect = view.grid.rect(id);
  for (int y = 0; y < rect.height; ++y)
    for (int x = 0; x < rect.width; ++x)
      paint(static_cast<std::size_t>(rect.y + y) * static_cast<std::size_t>(view.grid.image.width) +
                static_cast<std::size_t>(rect.x + x),
            x, y);
}

}  // namespace

std::vector<float> cost_per_pixel(const ViewState& view) {
  std::vector<float> seconds(static_cast<std::size_t>(view.pixels()));
  for (std::uint32_t i = 0; i < view.grid.count(); ++i) {
    const auto cost = static_cast<float>(per_pixel(view, {i}));
    each_pixel(view, {i}, [&](std::size_t place, int, int) { seconds[place] = cost; });
  }
  return seconds;
}

std::vector<std::uint8_t> cost_rgb8(const ViewState& view) {
  std::vector<std::uint8_t> rgb(3 * static_cast<std::size_t>(view.pixels()));
  const double most = dearest(view);
  for (std::uint32_t i = 0; i < view.grid.count(); ++i) {
    const auto color = viridis(most > 0 ? per_pixel(view, {i}) / most : 0);
    const PixelRect rect = view.grid.rect({i});
    each_pixel(view, {i}, [&](std::size_t place, int x, int y) {
      const bool edge = (x == 0 && rect.x > 0) || (y == 0 && rect.y > 0);
      for (std::size_t c = 0; c < 3; ++c)
        rgb[3 * place + c] = static_cast<std::uint8_t>(edge ? kEdge * color[c] : color[c]);
    });
  }
  return rgb;
}

std::string cost_scale(const ViewState& view) {
  const ImageSize tile{std::min(view.grid.tile.width, view.grid.image.width),
                       std::min(view.grid.tile.height, view.grid.image.height)};
  return fmt::format("0 to {:.3g} ms per {}x{} pixels",
                     1e3 * dearest(view) * tile.width * tile.height, tile.width, tile.height);
}

}  // namespace goldthread
