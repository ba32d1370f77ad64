// SPDX-License-Identifier: Apache-2.0
#include "bench/balance/tiling.h"

#include <algorithm>
#include <cmath>

namespace goldthread::bench {
namespace {

/// The multiple of 16 pixels whose squares are about so many.
int edge_for(ImageSize image, int tiles) {
  const double edge = std::sqrt(double(image.width) * image.height / tiles);
  return kCoarsestSpacing * std::max(1, int(std::lround(edge / kCoarsestSpacing)));
}

}  // namespace

ViewCut cut_of(Tiling tiling, ImageSize image, int threads) {
  switch (tiling) {
    case Tiling::kRows:
      return {TileGrid::rows_of(image)};
    case Tiling::kSquares64:
      return {TileGrid::squares(image, edge_for(image, 64))};
    case Tiling::kSquares256:
      return {TileGrid::squares(image, edge_for(image, 256))};
    case Tiling::kOwn:
      break;
  }
  return goldthread::cut_of({}, image, Sampling::kAdaptive, Update::kWhole, threads);
}

std::vector<Method> all_methods() {
  constexpr Strategy kByCost{.spare_us = kSpareUs}, kInOrder{Order::kScreen};
  return {{"64 squares, a block for each worker",
           Tiling::kSquares64,
           {Order::kScreen, Share::kContiguous}},
          {"64 squares, dealt in turn", Tiling::kSquares64, {Order::kScreen, Share::kInterleaved}},
          {"rows, in order", Tiling::kRows, kInOrder},
          {"64 squares, in order", Tiling::kSquares64, kInOrder},
          {"64 squares, by cost", Tiling::kSquares64, kByCost},
          {"256 squares, in order", Tiling::kSquares256, kInOrder},
          {"256 squares, by cost", Tiling::kSquares256, kByCost},
          {"own cut, by cost", Tiling::kOwn, kByCost}};
}

}  // namespace goldthread::bench
