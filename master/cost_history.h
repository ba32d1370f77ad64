// SPDX-License-Identifier: Apache-2.0
#pragma once
// What each tile cost in the last frame, per ray, and what it will therefore cost in the next:
// VOL2's observation that the last frame is the best predictor. Pure.

#include <chrono>
#include <cstdint>
#include <vector>

#include "common/tile/tile_grid.h"

namespace goldthread {

class CostHistory {
 public:
  /// Forgets what does not fit the grid: another grid starts from nothing.
  void fit(const TileGrid& grid);
  /// A quantum of `rays` rays in `tile` took `cost`.
  void record(TileId tile, std::uint64_t rays, std::chrono::microseconds cost);
  /// The predicted cost of `rays` rays in `tile`, in µs; the mean of the known tiles where the tile
  /// itself has never been cast, 0 where none has.
  double predict_us(TileId tile, std::uint64_t rays) const;
  /// Whether anything is known.
  bool empty() const { return known_ == 0; }

 private:
  TileGrid grid_;
  std::vector<double> us_per_ray_;  // negative: never cast
  std::size_t known_ = 0;
  double known_sum_ = 0;
};

}  // namespace goldthread
