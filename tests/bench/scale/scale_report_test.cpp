// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/scale_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace goldthread::bench {
namespace {

using testing::HasSubstr;

SweepPoint point_of(int megapixels, int workers, int masters, double efficiency, double busy) {
  SweepPoint point;
  point.megapixels = megapixels;
  point.tiles = 4096;
  point.tile_us = 1000;
  point.shape.workers = workers;
  point.shape.masters = masters;
  point.frame.us = 5000;
  point.frame.efficiency = efficiency;
  point.frame.master_busy = busy;
  return point;
}

ScaleReport made_up() {
  ScaleReport report;
  report.version = "0";
  report.scene = "a head";
  report.views = {"all in view, a ray in each pixel"};
  report.prices = {{{0.1, 0.01, 0}}};
  report.thread_seconds = {1.5};
  report.links = {{"MPI", {{64, 1, 2, 30}, {1024, 1, 2, 30}}}};
  report.model.link = fit_link(report.links[0]).costs;
  report.model.master = {{4096, 4, 3, 0.1, 1}};
  report.validation = {{"paced", "3 steps", 2, 1000, 1100}, {"paced", "3 steps", 4, 1000, 980}};
  report.one_level = {point_of(1, 64, 1, 0.9, 0.4), point_of(1, 1024, 1, 0.3, 0.95),
                      point_of(1, 4096, 1, 0.1, 0.99)};
  report.two_levels = {point_of(1, 4096, 1, 0.1, 0.99), point_of(1, 4096, 16, 0.85, 0.4)};
  report.with_second_level = {point_of(1, 64, 1, 0.9, 0.4), point_of(1, 4096, 16, 0.85, 0.4)};
  return report;
}

TEST(ScaleReport, SaysWhereOneMasterSaturates) {
  const Table table = saturation_table(made_up());
  ASSERT_EQ(table.rows.size(), 1U);
  // A tile of 1000 µs, and 4 + 3 + 1 + 2 µs of the master for it.
  EXPECT_EQ(table.rows[0][4], "100");
  EXPECT_EQ(table.rows[0][5], "1024");
  EXPECT_EQ(table.rows[0][6], "master");
  EXPECT_EQ(table.rows[0][7], "0.10");
}

TEST(ScaleReport, SaysWhatTheSecondLevelHasToBe) {
  const Table table = second_level_table(made_up());
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_EQ(table.rows[0][2], "0.10");
  EXPECT_EQ(table.rows[0][3], "16");
  EXPECT_EQ(table.rows[0][4], "256");
  EXPECT_EQ(table.rows[0][7], "0.85");
}

TEST(ScaleReport, TextsNameTheWorstRatio) {
  EXPECT_THAT(scale_text(made_up()), HasSubstr("off 1 by at most 10 %"));
  EXPECT_THAT(scale_markdown(made_up()), HasSubstr("| 1024 | 0.30 |"));
}

TEST(ScaleReport, IsJson) {
  const auto json = nlohmann::json::parse(scale_json(made_up()));
  EXPECT_EQ(json["bench"], "scale");
  EXPECT_EQ(json["oneLevel"].size(), 3U);
  EXPECT_EQ(json["oneLevel"][1]["limit"], "master");
  EXPECT_EQ(json["validation"][0]["ratio"], 1.1);
  EXPECT_EQ(json["links"][0]["times"].size(), 2U);
}

TEST(ScaleReport, PlotsACurveForEachSizeAndLevel) {
  const auto plots = scale_plots(made_up());
  ASSERT_EQ(plots.size(), 2U);
  EXPECT_THAT(plots[0].script, HasSubstr("1024 0.3\n"));
  EXPECT_THAT(plots[1].script, HasSubstr("1 Mpixel, two levels"));
  EXPECT_THAT(plots[1].script, HasSubstr("1 Mpixel, one master"));
}

}  // namespace
}  // namespace goldthread::bench
