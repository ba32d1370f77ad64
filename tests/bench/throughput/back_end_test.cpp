// SPDX-License-Identifier: Apache-2.0
#include "bench/throughput/back_end.h"

#include <gtest/gtest.h>

#include "tests/bench/error/small_subject.h"

namespace goldthread::bench {
namespace {

TEST(BackEnd, MeasuresEachPartOfEachKindOfFrame) {
  const auto rows = measure_back_end(test::ball_subject("back_end"), {96, 80}, 3);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].known, 1) << "each pixel has a ray";
  EXPECT_LT(rows[1].known, 1) << "adaptive";
  EXPECT_GT(rows[1].known, 1.0 / 64) << "more than the second grid";
  EXPECT_EQ(rows[2].known, 1);
  for (const BackEndRow& row : rows)
    for (const Seconds& part : {row.shown, row.jpeg, row.zstd, row.all_jpeg, row.all_zstd}) {
      EXPECT_EQ(part.count, 3);
      EXPECT_GT(part.minimum, 0);
    }
}

}  // namespace
}  // namespace goldthread::bench
