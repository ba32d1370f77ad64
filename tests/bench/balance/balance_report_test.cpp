// SPDX-License-Identifier: Apache-2.0
#include "bench/balance/balance_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace goldthread::bench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

BalanceReport example() {
  BalanceReport report;
  report.scene = "a scene";
  report.size = {256, 128};
  report.distances = {2, 1};
  report.rates = {{"rows", 2, false, {100, 50}},
                  {"squares", 2, false, {110, 60}},
                  {"squares", 8, true, {400, 200}}};
  report.gains = {{64, 4, -0.01, 0.02, 0.03}, {64, 8, 0.05, 0.12, 0.5}, {256, 32, 0, 0.08, 0.1}};
  report.imbalances = {{"a frame", 0.02, 0.04}};
  report.predictions = {{"orbit", 0.1, 0.09}};
  return report;
}

TEST(BalanceReport, GoalsAreReachedByTheirNumbersAlone) {
  const auto goals = balance_goals(example());
  ASSERT_EQ(goals.size(), 4u) << "of gains those with eight tiles for each worker";
  EXPECT_EQ(goals[0].reached, "2.0 %");
  EXPECT_EQ(goals[0].met, true);
  EXPECT_EQ(goals[1].reached, "4.0 %");
  EXPECT_EQ(goals[1].met, false);
  EXPECT_EQ(goals[2].reached, "12.0 %");
  EXPECT_EQ(goals[2].met, true);
  EXPECT_EQ(goals[3].met, false);
  EXPECT_THAT(balance_text(example()), HasSubstr("MISSED"));
}

TEST(BalanceReport, HasATableForEachMachineWithAColumnForEachDistance) {
  const auto sections = balance_sections(example());
  const auto measured = std::find_if(sections.begin(), sections.end(), [](const Section& section) {
    return section.title == "Frames a second, on this machine, 2 workers";
  });
  ASSERT_NE(measured, sections.end());
  EXPECT_THAT(measured->table.head, ElementsAre("<method", "2.00", "1.00"));
  EXPECT_THAT(measured->table.rows, ElementsAre(ElementsAre("rows", "100", "50.0"),
                                                ElementsAre("squares", "110", "60.0")));
  EXPECT_THAT(balance_markdown(example()), HasSubstr("replayed, 8 workers"));
}

TEST(BalanceReport, JsonHoldsAllRows) {
  const auto json = nlohmann::json::parse(balance_json(example()));
  EXPECT_EQ(json["bench"], "balance");
  EXPECT_EQ(json["rates"].size(), 3u);
  EXPECT_EQ(json["rates"][1]["framesPerSecond"], nlohmann::json({110.0, 60.0}));
  EXPECT_EQ(json["gains"][1]["median"], 0.12);
  EXPECT_EQ(json["imbalances"][0]["replayed"], 0.04);
  EXPECT_EQ(json["predictions"][0]["reprojected"], 0.09);
  EXPECT_EQ(json["goals"].size(), 4u);
}

TEST(BalanceReport, PlotsHaveACurveForEachMethod) {
  const auto plots = balance_plots(example());
  ASSERT_EQ(plots.size(), 2u);
  EXPECT_EQ(plots[0].name, "figure-9-measured");
  EXPECT_THAT(plots[0].script, HasSubstr("'rows'"));
  EXPECT_THAT(plots[0].script, HasSubstr("2 110\n1 60\n"));
  EXPECT_EQ(plots[1].name, "figure-9-8-workers");
}

}  // namespace
}  // namespace goldthread::bench
