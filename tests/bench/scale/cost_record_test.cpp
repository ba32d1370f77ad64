// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/cost_record.h"

#include <gtest/gtest.h>

namespace goldthread::bench {
namespace {

/// Block (column, row) of the one step costs 1 + column + 10 row.
CostRecord ramp(int columns, int rows) {
  CostRecord image{columns, rows, {{}}};
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      image.steps[0].push_back({double(1 + column + 10 * row), 100, 2});
  return image;
}

TEST(CostRecord, TilesAreSumsOfTheirBlocks) {
  const FrameWork work = work_of(ramp(4, 4), TileGrid::squares({64, 64}, 32));
  ASSERT_EQ(work.steps.size(), 1U);
  ASSERT_EQ(work.steps[0].size(), 4U);
  EXPECT_DOUBLE_EQ(work.steps[0][0].us, 1 + 2 + 11 + 12);
  EXPECT_DOUBLE_EQ(work.steps[0][1].us, 3 + 4 + 13 + 14);
  EXPECT_DOUBLE_EQ(work.steps[0][2].us, 21 + 22 + 31 + 32);
  EXPECT_DOUBLE_EQ(work.steps[0][3].bytes, 400);
  EXPECT_DOUBLE_EQ(work.steps[0][3].squared_error, 8);
}

TEST(CostRecord, FourTimesThePixelsCostFourTimesAsMuch) {
  const CostRecord image = ramp(8, 4);
  const FrameWork recorded = work_of(image, TileGrid::squares({128, 64}, 64));
  const FrameWork larger = work_of(image, TileGrid::squares({256, 128}, 64));
  EXPECT_DOUBLE_EQ(larger.us(), 4 * recorded.us());
  EXPECT_DOUBLE_EQ(larger.bytes(), 4 * recorded.bytes());
  // A large tile's cost is the recorded one's where it lies: the first covers 2 × 2 blocks.
  EXPECT_DOUBLE_EQ(larger.steps[0][0].us, 4 * (1 + 2 + 11 + 12));
}

TEST(CostRecord, PicturesOfOtherShapesKeepAllTiles) {
  const FrameWork work = work_of(ramp(3, 3), TileGrid::squares({100, 70}, 64));
  ASSERT_EQ(work.steps[0].size(), 4U);
  double bytes = 0;
  for (const StepCost& tile : work.steps[0]) bytes += tile.bytes;
  EXPECT_DOUBLE_EQ(bytes, 100 * 7 * 5);  // blocks that are begun
}

}  // namespace
}  // namespace goldthread::bench
