// SPDX-License-Identifier: Apache-2.0
#pragma once
// Lists of rays such as refinement asks for: all pixels of a tile, those between samples that
// differ, random ones. Pure. Pictures are one pixel larger than the image in both directions, for
// the samples beyond its right and lower edges.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/error/statistics.h"
#include "common/base/types.h"
#include "common/tile/sample.h"

namespace goldthread::bench {

constexpr int kTileEdge = 64;

/// The rays of one call.
using RayList = std::vector<PixelPosition>;

struct ListSet {
  std::string name;
  std::vector<RayList> lists;
};

/// Along the curve in whose order 4×4 neighbouring pixels follow each other, and 8×8, and so on.
std::uint32_t z_order(std::uint32_t x, std::uint32_t y);

/// A list for each tile: the pixels for which wanted(x, y), along the curve or row by row.
enum class Order : std::uint8_t { kCurve, kRows };
std::vector<RayList> lists_of(ImageSize image, Order order,
                              const std::function<bool(int x, int y)>& wanted);

/// Each pixel with probability `share`.
std::vector<RayList> random_lists(ImageSize image, Order order, double share);

/// Squares of 8 pixels whose corners differ by more than 24/255 in a channel are divided into four,
/// down to the pixel: for each level and tile the list of samples that this adds.
std::vector<RayList> subdivision_lists(ImageSize image, const std::vector<Color>& picture);

/// All pixels along the curve, cut into calls of `count` rays.
std::vector<RayList> batches(ImageSize image, std::size_t count);

}  // namespace goldthread::bench
