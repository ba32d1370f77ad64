// SPDX-License-Identifier: Apache-2.0
// What a commit makes of a transfer function: the table, and the cells that it makes visible.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "cast_support.h"
#include "worker/kernels/scene_terms.h"
#include "worker/kernels/transfer_table.h"
#include "worker/kernels/visible_cells.h"

namespace goldthread::test {
namespace {

VolumeInfo info_of(VoxelType type, double minimum, double maximum) {
  VolumeInfo info;
  info.type = type;
  info.minimum = minimum;
  info.maximum = maximum;
  return info;
}

double extinction_in(const TransferTable& table, double stored) {
  const double place =
      std::clamp((stored - double(table.first_value)) * double(table.rows_per_value), 0.0,
                 double(table.last_row));
  const double row = std::min(std::floor(place), double(table.last_row) - 1);
  const float* rows = table.rows + 4 * std::size_t(row);
  return rows[3] + (place - row) * (double(rows[7]) - rows[3]);
}

TEST(TransferTable, AFeatureOneValueWideIsKeptInIntegerData) {
  const TransferFunction function{.color = {{0, {1, 1, 1}}},
                                  .opacity = {{79, 0}, {80, 0.9}, {81, 0}}};
  for (const auto& info :
       {info_of(VoxelType::kUInt8, 0, 255), info_of(VoxelType::kInt16, -1024, 3071)}) {
    const double bias = info.type == VoxelType::kInt16 ? -32768 : 0;
    const TransferRows rows(function, info, bias, 1);
    for (const double value : {70.0, 79.0, 80.0, 81.0, 90.0})
      EXPECT_NEAR(extinction_in(rows.view(), value - bias), function.extinction_at(value), 1e-5)
          << value;
  }
}

TEST(TransferTable, NarrowFeaturesInFloatDataGetRowsEnough) {
  const TransferFunction function{.color = {{0, {1, 1, 1}}},
                                  .opacity = {{0, 0}, {499, 0}, {500, 0.5}, {501, 0}, {1000, 0}}};
  const TransferRows rows(function, info_of(VoxelType::kFloat32, 0, 1000), 0, 1);
  double worst = 0;
  for (double value = 498; value < 502; value += 0.003)
    worst = std::max(worst,
                     std::abs(extinction_in(rows.view(), value) - function.extinction_at(value)));
  EXPECT_LT(worst, 0.03);
}

TEST(TransferTable, AConstantVolumeHasATable) {
  const TransferFunction function{.color = {{0, {1, 1, 1}}}, .opacity = {{0, 0}, {100, 0.5}}};
  for (const VoxelType type : {VoxelType::kUInt8, VoxelType::kFloat32}) {
    const TransferRows rows(function, info_of(type, 50, 50), 0, 1);
    EXPECT_NEAR(extinction_in(rows.view(), 50), function.extinction_at(50), 1e-7);
  }
}

TEST(VisibleCells, ACellIsInvisibleExactlyWhereExtinctionIsZeroOverItsRange) {
  const TransferFunction function{
      .color = {},
      .opacity = {
          {10, 0}, {20, 0}, {25, 0.5}, {30, 0}, {40, 0}, {40, 0.1}, {40, 0}, {50, 0}, {60, 0.2}}};
  const CellVisibility visible(&function, {}, 0);
  std::mt19937 random(5);
  for (int trial = 0; trial < 2000; ++trial) {
    const double low = double(random() % 140) / 2, high = low + double(random() % 30) / 2;
    bool expected = false;
    for (double value = low; value <= high; value += 0.0625)
      expected = expected || function.extinction_at(value) > 0;
    // The spike at 40 has no width; whoever spans it sees it in the nodes.
    expected = expected || (low <= 40 && 40 <= high);
    EXPECT_EQ(visible({float(low), float(high)}), expected) << low << ' ' << high;
  }
}

TEST(VisibleCells, ACellWithoutFiniteVoxelsIsInvisible) {
  const TransferFunction function{.color = {}, .opacity = {{0, 1}}};
  const CellVisibility visible(&function, {}, 0);
  EXPECT_FALSE(visible({INFINITY, -INFINITY}));
  EXPECT_TRUE(visible({0, 0}));
}

TEST(VisibleCells, ACellThatHoldsAnIsovalueIsVisible) {
  const std::vector<Isosurface> surfaces{{.value = 5}, {.value = -3}};
  const CellVisibility visible(nullptr, surfaces, -10);
  EXPECT_TRUE(visible({15, 20}));
  EXPECT_TRUE(visible({0, 7}));
  EXPECT_FALSE(visible({8, 14}));
}

TEST(VisibleCells, DistancesAreChebyshevsToTheOtherKind) {
  const glm::ivec3 counts(13, 9, 7);
  const std::vector<Isosurface> surfaces{{.value = 1}};
  std::mt19937 random(2);
  for (const double share : {0.01, 0.5, 0.99}) {
    std::vector<CellRange> cells(std::size_t(counts.x * counts.y * counts.z), {0, 0});
    for (CellRange& cell : cells)
      if (std::uniform_real_distribution<double>()(random) < share) cell = {1, 1};
    const auto found = cell_distances(cells, counts, CellVisibility(nullptr, surfaces, 0));
    const auto at = [&](glm::ivec3 c) {
      return std::size_t((c.z * counts.y + c.y) * counts.x + c.x);
    };
    const auto for_each_cell = [&](const auto& use) {
      for (int z = 0; z < counts.z; ++z)
        for (int y = 0; y < counts.y; ++y)
          for (int x = 0; x < counts.x; ++x) use(glm::ivec3(x, y, z));
    };
    for_each_cell([&](glm::ivec3 cell) {
      const bool visible = cells[at(cell)].maximum == 1;
      int expected = kMostCellDistance;
      for_each_cell([&](glm::ivec3 other) {
        if ((cells[at(other)].maximum == 1) == visible) return;
        const glm::ivec3 d = glm::abs(other - cell);
        expected = std::min(expected, std::max({d.x, d.y, d.z}));
      });
      EXPECT_EQ(found[at(cell)], expected + (visible ? kCellIsVisible : 0));
    });
  }
}

TEST(Step, DefaultsToAShareOfTheSmallestSpacingAndNeverNeedsTooManySegments) {
  const VolumeGeometry geometry{.size = {100, 100, 100}, .spacing_mm = {1, 2, 0.6}};
  const Features unlit{.dvr = true}, lit{.dvr = true, .shading = true};
  EXPECT_DOUBLE_EQ(step_of(0, geometry, unlit), 0.3);
  EXPECT_DOUBLE_EQ(step_of(0, geometry, lit), 0.12);
  EXPECT_DOUBLE_EQ(step_of(0.7, geometry, unlit), 0.7);
  EXPECT_DOUBLE_EQ(step_of(0.7, geometry, lit), 0.7);
  EXPECT_GT(step_of(1e-30, geometry, unlit), 1e-4);
}

TEST(Step, FollowsTheErrorThatAPictureMayHave) {
  const VolumeGeometry geometry{.size = {100, 100, 100}, .spacing_mm = {1, 2, 0.5}};
  const Features unlit{.dvr = true}, lit{.dvr = true, .shading = true}, mip{.mip = true};
  const Features surfaces{.shading = true, .isosurfaces = true};
  // Where a quarter of the error is what the step alone causes.
  EXPECT_DOUBLE_EQ(step_for_error(4 * 0.17, geometry, unlit), 0.5);
  EXPECT_DOUBLE_EQ(step_for_error(4 * 0.17, geometry, mip), 0.5);
  EXPECT_DOUBLE_EQ(step_for_error(4 * 1.58, geometry, lit), 0.5);
  for (const Features& features : {unlit, lit, mip, surfaces}) {
    double last = step_of(0, geometry, features);
    EXPECT_DOUBLE_EQ(step_for_error(0.01, geometry, features), last);
    for (double error = 0.1; error < 255; error *= 1.5) {
      const double step = step_for_error(error, geometry, features);
      EXPECT_GE(step, last);
      last = step;
    }
    EXPECT_LE(last, 1);
  }
  EXPECT_DOUBLE_EQ(step_for_error(255, geometry, surfaces), step_of(0, geometry, surfaces));
}

}  // namespace
}  // namespace goldthread::test
