// SPDX-License-Identifier: Apache-2.0
// The whole bench, on a volume of 24³ voxels.

#include "bench/balance/bench_balance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/balance/tiling.h"
#include "tests/bench/error/small_subject.h"

namespace goldthread::bench {
namespace {

TEST(BalanceBench, MeasuresEachMethodAtEachDistance) {
  Subject subject = test::ball_subject("bench_balance");
  subject.scene.image.size = {256, 256};
  BalanceBenchSettings settings;
  settings.quick = true;
  settings.repeats = 1;
  const BalanceReport report = run_balance_bench(subject, settings);
  ASSERT_EQ(report.rates.size(), 3 * all_methods().size()) << "measured, and replayed for 4 and 8";
  for (const RateRow& row : report.rates) {
    ASSERT_EQ(row.frames_per_second.size(), report.distances.size());
    for (const double rate : row.frames_per_second) EXPECT_TRUE(rate > 0 && std::isfinite(rate));
  }
  EXPECT_EQ(report.gains.size(), 10u);
  EXPECT_EQ(report.imbalances.size(), 4u);
  ASSERT_EQ(report.predictions.size(), 4u);
  for (const PredictionRow& row : report.predictions) EXPECT_GT(row.as_it_was, 0) << row.path;
}

TEST(Tiling, HasAsManySquaresAsItsName) {
  EXPECT_EQ(cut_of(Tiling::kSquares64, {512, 512}, 2).grid.count(), 64u);
  EXPECT_EQ(cut_of(Tiling::kSquares256, {512, 512}, 2).grid.count(), 256u);
  EXPECT_EQ(cut_of(Tiling::kRows, {512, 512}, 2).grid.count(), 32u);
  EXPECT_TRUE(cut_of(Tiling::kOwn, {512, 512}, 2).split);
}

}  // namespace
}  // namespace goldthread::bench
