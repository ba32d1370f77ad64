// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/cost_record.h"

#include <cstdint>

namespace goldthread::bench {
namespace {

int blocks_along(int pixels) { return (pixels + kBlockPixels - 1) / kBlockPixels; }

double sum_of(const FrameWork& work, double StepCost::*member) {
  double sum = 0;
  for (const auto& tiles : work.steps)
    for (const StepCost& tile : tiles) sum += tile.*member;
  return sum;
}

}  // namespace

StepCost& StepCost::operator+=(const StepCost& other) {
  us += other.us;
  bytes += other.bytes;
  squared_error += other.squared_error;
  return *this;
}

double FrameWork::us() const { return sum_of(*this, &StepCost::us); }
double FrameWork::bytes() const { return sum_of(*this, &StepCost::bytes); }

FrameWork work_of(const CostRecord& image, const TileGrid& grid) {
  FrameWork work{grid, {}};
  const int columns = blocks_along(grid.image.width), rows = blocks_along(grid.image.height);
  const auto recorded = [&](int column, int row) {
    const auto at = [](int index, int count, int recorded_count) {
      return static_cast<std::size_t>(std::int64_t(index) * recorded_count / count);
    };
    return at(row, rows, image.rows) * std::size_t(image.columns) +
           at(column, columns, image.columns);
  };
  for (const std::vector<StepCost>& blocks : image.steps) {
    std::vector<StepCost>& tiles = work.steps.emplace_back(grid.count());
    for (int row = 0; row < rows; ++row) {
      const int tile_row = row * kBlockPixels / grid.tile.height;
      for (int column = 0; column < columns; ++column) {
        const int tile = tile_row * grid.columns() + column * kBlockPixels / grid.tile.width;
        tiles[std::size_t(tile)] += blocks[recorded(column, row)];
      }
    }
  }
  return work;
}

}  // namespace goldthread::bench
