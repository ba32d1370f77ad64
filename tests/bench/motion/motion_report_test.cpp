// SPDX-License-Identifier: Apache-2.0
#include "bench/motion/motion_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace goldthread::bench {
namespace {

using testing::HasSubstr;

Showing showing(double rms, double latency) {
  Showing result;
  for (int i = 1; i <= 3; ++i) {
    result.seconds.push_back(i / 60.0);
    result.rms.push_back(rms * i);
    result.latency.push_back(latency);
  }
  result.pictures_per_second = 60;
  return result;
}

MotionReport example() {
  MotionReport report;
  report.scene = "a scene";
  report.size = {256, 128};
  report.full_frame_seconds = 0.02;
  report.cost_factor = 5;
  report.paths = {{"slow orbit", "20° a second"}, {"jitter", "a head"}};
  report.rows = {{"slow orbit", "one", showing(1, 0.01)},
                 {"slow orbit", "other", showing(2, 0.02)},
                 {"jitter", "one", showing(4, 0.03)}};
  return report;
}

TEST(MotionReport, TheTableHasARowForEachPathAndMethod) {
  const Table table = motion_table(example());
  EXPECT_THAT(table.rows,
              testing::ElementsAre(
                  testing::ElementsAre("slow orbit", "one", "2.00", "3.00", "60.0", "10.0"),
                  testing::ElementsAre("slow orbit", "other", "4.00", "6.00", "60.0", "20.0"),
                  testing::ElementsAre("jitter", "one", "8.00", "12.0", "60.0", "30.0")));
}

TEST(MotionReport, ItSaysWhereInterruptibleIsNotTheBest) {
  MotionReport report = example();
  EXPECT_TRUE(motion_findings(report).empty()) << "it was not measured";
  report.rows.push_back({"slow orbit", kInterruptible, showing(2.5, 0.01)});
  report.rows.push_back({"jitter", kInterruptible, showing(3, 0.01)});
  EXPECT_THAT(
      motion_findings(report),
      testing::ElementsAre("slow orbit: the least is 2.00, one; interruptible 5.00 (2.50 times)",
                           "jitter: interruptible has the least error, 6.00"));
  EXPECT_THAT(motion_text(report), HasSubstr("the least is 2.00, one"));
  EXPECT_THAT(motion_markdown(report), HasSubstr("- jitter: interruptible has"));
}

TEST(MotionReport, TheTextSaysWhatAFullFrameCosts) {
  EXPECT_THAT(motion_text(example()), HasSubstr("a scene, 256×128 pixels, a full frame in 100 ms"));
}

TEST(MotionReport, TheJsonHoldsEachLook) {
  const auto json = nlohmann::json::parse(motion_json(example()));
  EXPECT_EQ(json["bench"], "motion");
  EXPECT_EQ(json["rows"].size(), 3u);
  EXPECT_EQ(json["rows"][1]["rms"], nlohmann::json({2.0, 4.0, 6.0}));
  EXPECT_EQ(json["costFactor"], 5);
}

TEST(MotionReport, EachPathHasAPlotWithItsMethods) {
  const auto plots = motion_plots(example());
  ASSERT_EQ(plots.size(), 2u);
  EXPECT_EQ(plots[0].name, "slow-orbit");
  EXPECT_THAT(plots[0].script, HasSubstr("title 'other'"));
  EXPECT_THAT(plots[1].script, testing::Not(HasSubstr("title 'other'")));
  EXPECT_THAT(plots[1].script, HasSubstr("set output 'jitter.svg'"));
}

}  // namespace
}  // namespace goldthread::bench
