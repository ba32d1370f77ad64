// SPDX-License-Identifier: Apache-2.0
#pragma once
// The small value types that every room shares. What must not be mixed up has a type of its own.

#include <compare>
#include <cstdint>
#include <tuple>

namespace goldthread {

/// Names a view (camera + scene revision). Grows by one with each new view; never wraps in
/// practice.
struct Epoch {
  std::uint32_t value = 0;
  auto operator<=>(const Epoch&) const = default;
  static constexpr auto fields() { return std::tuple{&Epoch::value}; }
};

/// A process (MPI) or thread (loopback) of the cluster: 0 is the master, then compositors, then
/// workers.
struct Rank {
  std::int32_t value = 0;
  auto operator<=>(const Rank&) const = default;
  static constexpr auto fields() { return std::tuple{&Rank::value}; }
};

/// A tile's number in its TileGrid, row by row from the top left.
struct TileId {
  std::uint32_t value = 0;
  auto operator<=>(const TileId&) const = default;
  static constexpr auto fields() { return std::tuple{&TileId::value}; }
};

/// Width and height of an image in pixels.
struct ImageSize {
  std::int32_t width = 0;
  std::int32_t height = 0;
  auto operator<=>(const ImageSize&) const = default;
  static constexpr auto fields() { return std::tuple{&ImageSize::width, &ImageSize::height}; }
};

/// Pixels [x, x+width) × [y, y+height); y grows downwards, (0, 0) is the top left pixel.
struct PixelRect {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t width = 0;
  std::int32_t height = 0;
  auto operator<=>(const PixelRect&) const = default;
  static constexpr auto fields() {
    return std::tuple{&PixelRect::x, &PixelRect::y, &PixelRect::width, &PixelRect::height};
  }
};

}  // namespace goldthread
