// SPDX-License-Identifier: Apache-2.0
#include "bench/throughput/throughput_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace goldthread::bench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

FramesRow row(Carrier carrier, int side, int workers, double seconds, double tiles) {
  FramesRow row;
  row.setup.carrier = carrier;
  row.setup.size = {side, side};
  row.setup.workers = workers;
  row.frames.tiles = static_cast<std::uint32_t>(tiles);
  row.frames.seconds = {seconds, seconds, seconds};
  row.frames.lossless_seconds = {2 * seconds};
  row.frames.sample_bytes = 1e6;
  row.frames.master_cpu_seconds = 4 * seconds;  // all the time
  row.frames.paced = {60, 1, 1.0, 0.015};
  return row;
}

/// 0.02 s of 1 MB: 50 MB/s of MPI's 100 or 60.
ThroughputReport example() {
  ThroughputReport report;
  report.scene = "a scene";
  report.back_end_size = {1024, 1024};
  report.bypassed = {row(Carrier::kSharedMemory, 512, 1, 0.02, 64),
                     row(Carrier::kSharedMemory, 1024, 1, 0.02, 256),
                     row(Carrier::kThreads, 1024, 1, 0.01, 256)};
  report.bypassed[0].stream = StreamResult{1e6, {0.01}};
  report.bypassed[1].stream = StreamResult{1e6, {1.0 / 60}};
  report.master = {row(Carrier::kSharedMemory, 512, 1, 0.01, 100),
                   row(Carrier::kSharedMemory, 512, 8, 0.001, 60)};
  report.back_end = {row(Carrier::kSharedMemory, 1024, 1, 0.05, 256)};
  BackEndRow part;
  part.samples = "adaptive";
  part.known = 0.25;
  part.shown = {0.004, 0.005, 5};
  part.jpeg = {0.002, 0.003, 5};
  part.zstd = {0.006, 0.007, 5};
  part.all_jpeg = {0.008, 0.009, 5};
  part.all_zstd = {0.010, 0.011, 5};
  report.parts = {part};
  return report;
}

const Goal* goal_about(const std::vector<Goal>& goals, const std::string& what) {
  for (const Goal& goal : goals)
    if (goal.what.find(what) != std::string::npos) return &goal;
  return nullptr;
}

TEST(ThroughputReport, TheFirstFigureStandsBesideMpiAlone) {
  const auto sections = throughput_sections(example());
  ASSERT_EQ(sections.size(), 5u);
  EXPECT_THAT(sections[1].table.rows,
              ElementsAre(ElementsAre("MPI, shared memory", "512×512", "50.0", "50.0 … 50.0",
                                      "3200", "50.0", "100", "0.500", "–"),
                          ElementsAre("MPI, shared memory", "1024×1024", "50.0", "50.0 … 50.0",
                                      "12800", "50.0", "60.0", "0.833", "–"),
                          ElementsAre("one process", "1024×1024", "100", "100 … 100", "25600",
                                      "100", "–", "–", "–")));
}

TEST(ThroughputReport, OfSeveralRoundsTheOneWithTheMiddleShareIsTold) {
  std::vector<FramesRow> rounds;
  for (const double stream_seconds : {0.01, 0.02, 0.004}) {
    rounds.push_back(row(Carrier::kTcp, 1024, 1, 0.02, 64));
    rounds.back().stream = StreamResult{1e6, {stream_seconds}};
  }
  const FramesRow middle = middle_of(rounds);
  EXPECT_THAT(middle.stream->seconds, ElementsAre(0.01));
  EXPECT_THAT(middle.shares, ElementsAre(0.2, 0.5, 1.0));
  ThroughputReport report;
  report.bypassed = {middle};
  EXPECT_EQ(throughput_sections(report)[1].table.rows[0].back(), "0.200 … 1.00");
}

TEST(ThroughputReport, TheOtherFiguresAreAboutOneRole) {
  const auto sections = throughput_sections(example());
  EXPECT_THAT(sections[2].table.rows[1],
              ElementsAre("MPI, shared memory", "8", "512×512", "60 of 64²", "1000", "1000 … 1000",
                          "60000", "60000", "1.50 %", "1 of 60"));
  EXPECT_THAT(sections[3].table.rows,
              ElementsAre(ElementsAre("MPI, shared memory", "1024×1024", "20.0", "20.0 … 20.0",
                                      "10.0", "10.0 … 10.0")));
  EXPECT_THAT(sections[4].table.rows[0],
              ElementsAre("adaptive", "25 %", "5.00", "3.00", "7.00", "9.00", "11.0"));
}

TEST(ThroughputGoals, AreMetOrMissedByTheWorstOrBestRowThatTheyAreAbout) {
  ThroughputReport report = example();
  auto goals = throughput_goals(report);
  // Small pictures are left out of the share, and what was not measured has no answer.
  EXPECT_EQ(goal_about(goals, "MPI alone, 1024×1024 and above, MPI, shared")->met, true);
  EXPECT_EQ(goal_about(goals, "MPI alone, 1024×1024 and above, MPI, TCP")->met, std::nullopt);
  EXPECT_EQ(goal_about(goals, "tiles per second that the master")->met, true);
  EXPECT_EQ(goal_about(goals, "percent of a core")->met, true);
  EXPECT_EQ(goal_about(goals, "adaptive, JPEG")->met, true);
  EXPECT_EQ(goal_about(goals, "adaptive, zstd")->met, false);

  report.bypassed[1].stream = StreamResult{1e6, {0.01}};
  report.master[1].frames.paced.master_cpu_seconds = 0.021;
  report.master[1].frames.tiles = 40;
  goals = throughput_goals(report);
  EXPECT_EQ(goal_about(goals, "MPI alone, 1024×1024 and above, MPI, shared")->met, false);
  EXPECT_EQ(goal_about(goals, "tiles per second that the master")->met, false);
  EXPECT_EQ(goal_about(goals, "percent of a core")->met, false);
}

TEST(ThroughputReport, PlotsShowMpiAloneAsFramesPerSecond) {
  const auto plots = throughput_plots(example());
  ASSERT_EQ(plots.size(), 3u);
  EXPECT_EQ(plots[0].name, "everything-bypassed");
  EXPECT_THAT(plots[0].script, HasSubstr("'MPI, shared memory, without Goldthread'"));
  EXPECT_THAT(plots[0].script, HasSubstr("512 100\n1024 60\n"));
  EXPECT_THAT(plots[1].script, HasSubstr("set xlabel 'workers'"));
  EXPECT_THAT(plots[2].script, HasSubstr("1024 20\n"));
  for (const Plot& plot : throughput_plots(ThroughputReport{})) EXPECT_TRUE(plot.script.empty());
}

TEST(ThroughputReport, JsonHoldsAllFramesAndTheGoals) {
  const auto json = nlohmann::json::parse(throughput_json(example()));
  EXPECT_EQ(json["bench"], "throughput");
  EXPECT_EQ(json["everythingBypassed"].size(), 3u);
  EXPECT_EQ(json["everythingBypassed"][0]["mpiAloneBytesPerSecond"], 1e8);
  EXPECT_FALSE(json["everythingBypassed"][2].contains("stream"));
  EXPECT_EQ(json["masterAlone"][1]["workers"], 8);
  EXPECT_EQ(json["backEndAlone"][0]["frames"]["seconds"].size(), 3u);
  EXPECT_EQ(json["goals"].size(), throughput_goals(example()).size());
  EXPECT_TRUE(json["goals"][1]["met"].is_null());
}

TEST(ThroughputReport, TextAndMarkdownHoldEachSectionAndTheNotes) {
  ThroughputReport report = example();
  report.notes = {"no mpirun"};
  for (const std::string& text : {throughput_text(report), throughput_markdown(report)}) {
    for (const Section& section : throughput_sections(report))
      EXPECT_THAT(text, HasSubstr(section.title));
    EXPECT_THAT(text, HasSubstr("no mpirun"));
  }
}

}  // namespace
}  // namespace goldthread::bench
