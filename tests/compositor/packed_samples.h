// SPDX-License-Identifier: Apache-2.0
#pragma once
// Messages of samples as a worker packs them.

#include <cstring>
#include <vector>

#include "common/protocol/messages.h"

namespace goldthread {

/// Of epoch 1. As many colours as places.
inline Samples packed(TileId tile, Step from, Step to, const std::vector<SampleOffset>& places,
                      const std::vector<Sample>& colors) {
  const std::size_t color_bytes = colors.size() * sizeof(Sample);
  const std::size_t place_bytes = places.size() * sizeof(SampleOffset);
  Samples message{{1},
                  tile,
                  from,
                  to,
                  static_cast<std::uint32_t>(places.size()),
                  Buffer(color_bytes + place_bytes)};
  if (places.empty()) return message;
  std::memcpy(message.packed.data(), colors.data(), color_bytes);
  std::memcpy(message.packed.data() + color_bytes, places.data(), place_bytes);
  return message;
}

/// The spacing that a step brings in these tests: 16, 8, 4, 2 and 1 pixels.
constexpr int spacing_of(Step step) { return 32 >> step.value; }
constexpr Step kPixelStep{5};

/// A tile's samples of a step, each what `color(x, y)` says of its pixel's centre.
template <class Color>
Samples packed_grid(const TileGrid& grid, TileId tile, Step from, Step to, Color color) {
  const PixelRect rect = grid.rect(tile);
  const auto places = grid_places({rect.width, rect.height}, spacing_of(to));
  std::vector<Sample> colors;
  for (const SampleOffset place : places) {
    const PixelPosition position = position_of(rect, place);
    colors.push_back(color(position.x, position.y));
  }
  return packed(tile, from, to, places, colors);
}

}  // namespace goldthread
