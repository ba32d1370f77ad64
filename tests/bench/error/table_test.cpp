// SPDX-License-Identifier: Apache-2.0
#include "bench/error/table.h"

#include <gtest/gtest.h>

#include <limits>

namespace goldthread::bench {
namespace {

TEST(BenchTable, ColumnsAreAsWideAsTheirWidestCell) {
  const Table table{{"<name", "ms"}, {{"a", "1"}, {"longer", "1234"}}};
  EXPECT_EQ(as_text(table),
            "name      ms\n"
            "a          1\n"
            "longer  1234\n");
}

TEST(BenchTable, WidthsCountCharactersNotBytes) {
  const Table table{{"<µ", "n"}, {{"×÷≤", "1"}, {"ab", "2"}}};
  EXPECT_EQ(as_text(table),
            "µ    n\n"
            "×÷≤  1\n"
            "ab   2\n");
}

TEST(BenchTable, ShortRowsEndInEmptyCellsWithoutTrailingSpace) {
  const Table table{{"<a", "<b"}, {{"x"}}};
  EXPECT_EQ(as_text(table), "a  b\nx\n");
  EXPECT_EQ(as_markdown(table), "| a | b |\n|---|---|\n| x |  |\n");
}

TEST(BenchTable, MarkdownKeepsBarsAndLineBreaksOutOfItsSyntax) {
  const Table table{{"<a", "n"}, {{"x|y\nz", "1"}}};
  EXPECT_EQ(as_markdown(table), "| a | n |\n|---|---:|\n| x\\|y z | 1 |\n");
}

TEST(BenchTable, NumbersHaveThreeSignificantDigits) {
  EXPECT_EQ(number(0.012345), "0.0123");
  EXPECT_EQ(number(1.2345), "1.23");
  EXPECT_EQ(number(12.345), "12.3");
  EXPECT_EQ(number(123.45), "123");
  EXPECT_EQ(number(12345), "12345");
  EXPECT_EQ(number(9.996), "10.0");
  EXPECT_EQ(number(-0.5), "-0.500");
  EXPECT_EQ(number(0), "0");
  EXPECT_EQ(number(1.5e-7), "1.5e-07");
  EXPECT_EQ(number(std::numeric_limits<double>::quiet_NaN()), "–");
  EXPECT_EQ(number(std::numeric_limits<double>::infinity()), "–");
  EXPECT_EQ(milliseconds(0.0765), "76.5");
}

}  // namespace
}  // namespace goldthread::bench
