// SPDX-License-Identifier: Apache-2.0
#include "bench/error/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "example_report.h"

namespace goldthread::bench {
namespace {

using testing::HasSubstr;
using testing::Not;

/// The goals that are not met, or not measured, by their words.
std::vector<std::string> unmet(const Report& report) {
  std::vector<std::string> words;
  for (const Goal& goal : goals_of(report))
    if (goal.met != std::optional(true)) words.push_back(goal.what + ": " + goal.reached);
  return words;
}

TEST(BenchReport, EachGoalIsMetByAReportThatMeetsIt) {
  EXPECT_THAT(unmet(test::example_report()), testing::IsEmpty());
}

TEST(BenchReport, ASpeedUpIsTheRatioOfMedians) {
  const Goal goal = goals_of(test::example_report()).front();
  EXPECT_THAT(goal.reached, HasSubstr("VTK / 20.0 (200 ms : 10.0 ms)"));
}

TEST(BenchReport, AGoalMissedIsNamedWithItsNumber) {
  Report report = test::example_report();
  for (MethodRow& row : report.methods)
    if (row.program == "Goldthread" && row.look == Look::kPhong && row.step_voxels == 0)
      row.error.rms = 0.7;
  EXPECT_THAT(unmet(report), testing::ElementsAre("error at default settings, Phong: 0.700"));
  report.memory.block_bytes = 2000;
  EXPECT_EQ(unmet(report).size(), 2u);
}

TEST(BenchReport, AdaptiveRefinementMustBeCheapAndHonest) {
  Report report = test::example_report();
  report.adaptive.rows.front().cast_seconds = 0.85 * report.adaptive.rows.front().cpu_seconds;
  EXPECT_EQ(unmet(report).size(), 1u);
  report.adaptive.rows.back().rms = 1.3 * report.adaptive.rows.back().target;
  EXPECT_EQ(unmet(report).size(), 2u);
  report.adaptive.calibration.front().estimated = 0.6 * report.adaptive.calibration.front().rms;
  EXPECT_EQ(unmet(report).size(), 3u);
  report.adaptive.first_pictures.back().seconds.median = 0.02;
  EXPECT_EQ(unmet(report).size(), 4u);
}

TEST(BenchReport, WhatIsOffMayCostOnePercent) {
  Report report = test::example_report();
  report.features.back().by_rounds = 0.985;
  EXPECT_EQ(unmet(report).size(), 1u);
}

TEST(BenchReport, GoalsAgainstAMissingPeerAreNotMeasured) {
  Report report = test::example_report();
  report.latencies.clear();
  std::erase_if(report.methods, [](const MethodRow& row) { return row.program == "VTK"; });
  report.adaptive.every_pixel.clear();
  int open = 0;
  for (const Goal& goal : goals_of(report)) open += !goal.met;
  EXPECT_EQ(open, 12);
  EXPECT_THAT(report_text(report), HasSubstr("not measured"));
}

TEST(BenchReport, AReferenceMustBeTenTimesBetterThanWhatItMeasures) {
  EXPECT_TRUE((ReferenceRow{Look::kUnlit, 64, 0.04, 0.01, 0.1}.is_converged()));
  EXPECT_FALSE((ReferenceRow{Look::kUnlit, 64, 0.04, 0.011, 0.1}.is_converged()));
}

TEST(BenchReport, MemoryBeyondTheVoxelsCountsBlockAndTables) {
  EXPECT_DOUBLE_EQ((MemoryFigures{1000, 1200, 50}.beyond()), 0.25);
  EXPECT_EQ(MemoryFigures{}.beyond(), 0);
}

TEST(BenchReport, JsonHoldsEveryRow) {
  const Report report = test::example_report();
  const auto json = nlohmann::json::parse(report_json(report));
  EXPECT_EQ(json["bench"], "error");
  EXPECT_EQ(json["machine"]["processor"], "A processor");
  EXPECT_EQ(json["methods"].size(), report.methods.size());
  EXPECT_EQ(json["methods"][0]["stepVoxels"], "default");
  EXPECT_EQ(json["methods"][1]["stepVoxels"], 0.5);
  EXPECT_EQ(json["methods"][1]["samplesPerSecond"], 4e8);
  EXPECT_EQ(json["goals"].size(), goals_of(report).size());
  EXPECT_EQ(json["goals"][0]["met"], true);
  EXPECT_EQ(json["features"][1]["medianRatio"], 1.001);
  EXPECT_EQ(json["peers"][1]["missing"], "pvbatch is not installed");
}

TEST(BenchReport, JsonSurvivesNumbersThatAreNoneAndWordsThatAreNotText) {
  Report report = test::example_report();
  report.methods[0].error.rms = std::numeric_limits<double>::quiet_NaN();
  report.peers[0].failure = "\xff\xfe";
  EXPECT_TRUE(nlohmann::json::parse(report_json(report))["methods"][0]["error"]["rms"].is_null());
}

TEST(BenchReport, TextAndMarkdownHoldTheSameSections) {
  const Report report = test::example_report();
  const std::string text = report_text(report), markdown = report_markdown(report);
  for (const Section& section : sections_of(report)) {
    EXPECT_THAT(text, HasSubstr("\n" + section.title + "\n"));
    EXPECT_THAT(markdown, HasSubstr("\n### " + section.title + "\n"));
    EXPECT_THAT(markdown, HasSubstr(as_markdown(section.table)));
  }
  EXPECT_THAT(text, HasSubstr("moved by (0.5, -1) px"));
  EXPECT_THAT(text, HasSubstr("missing: pvbatch is not installed"));
}

TEST(BenchReport, AnotherSceneIsNotHeldAgainstTheGoalsInSilence) {
  Report report = test::example_report();
  EXPECT_THAT(report_text(report), Not(HasSubstr("another scene")));
  report.default_scene = false;
  EXPECT_THAT(report_text(report), HasSubstr("another scene"));
}

}  // namespace
}  // namespace goldthread::bench
