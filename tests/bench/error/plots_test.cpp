// SPDX-License-Identifier: Apache-2.0
#include "bench/error/plots.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "example_report.h"

namespace goldthread::bench {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string script(const Report& report, const std::string& name) {
  for (const Plot& plot : plots_of(report))
    if (plot.name == name) return plot.script;
  ADD_FAILURE() << "no plot " << name;
  return "";
}

TEST(BenchPlots, EachPlotIsDrawnAsSvgAndAsPng) {
  const auto plots = plots_of(test::example_report());
  ASSERT_EQ(plots.size(), 5u);
  for (const Plot& plot : plots) {
    EXPECT_THAT(plot.script, HasSubstr("set output '" + plot.name + ".svg'"));
    EXPECT_THAT(plot.script, HasSubstr("set output '" + plot.name + ".png'"));
  }
}

TEST(BenchPlots, ErrorAgainstTimeHasACurveForEachProgramAndLook) {
  const std::string text = script(test::example_report(), "error-time");
  for (const char* title :
       {"'Goldthread, unlit'", "'Goldthread, Phong'", "'VTK, mip'", "'Goldthread''s default step'"})
    EXPECT_THAT(text, HasSubstr(title));
  EXPECT_THAT(text, HasSubstr("set logscale xy"));
  EXPECT_THAT(text, HasSubstr("$curve0 << END\n10 0.1\n5 0.4\nEND\n"));
}

TEST(BenchPlots, ErrorAgainstStepHasAGuideOfSlopeTwo) {
  const std::string text = script(test::example_report(), "error-step");
  const auto guide = text.rfind("<< END\n");
  ASSERT_NE(guide, std::string::npos);
  std::istringstream numbers(text.substr(guide + 7));
  double coarse_step = 0, coarse_error = 0, fine_step = 0, fine_error = 0;
  numbers >> coarse_step >> coarse_error >> fine_step >> fine_error;
  EXPECT_NEAR(order_between(coarse_step, coarse_error, fine_step, fine_error), 2, 1e-6);
}

TEST(BenchPlots, ErrorsAtRoundoffAreDrawnAtTheLowerEnd) {
  Report report = test::example_report();
  for (MethodRow& row : report.methods)
    if (row.look == Look::kMip && row.program == "Goldthread") row.error.rms = 0;
  EXPECT_THAT(script(report, "error-time"), HasSubstr("<< END\n10 0.001\n5 0.001\nEND\n"));
}

TEST(BenchPlots, WhatTookNoTimeIsLeftOut) {
  Report report = test::example_report();
  for (MethodRow& row : report.methods)
    if (row.look == Look::kMip && row.program == "VTK") row.seconds = {};
  EXPECT_THAT(script(report, "error-time"), Not(HasSubstr("'VTK, mip'")));
}

TEST(BenchPlots, ParaViewIsAPointAtItsDefault) {
  Report report = test::example_report();
  report.methods.push_back(test::method_row("ParaView", Look::kUnlit, 0, 2, 0.5));
  EXPECT_THAT(script(report, "error-time"), HasSubstr("2000 0.5\n"));
  EXPECT_THAT(script(report, "error-step"), Not(HasSubstr("ParaView")));
}

TEST(BenchPlots, SamplesPerSecondHasAGroupForEachInstructionSet) {
  Report report = test::example_report();
  report.gathers.push_back({"SSE4", {0.01, 0.01, 9}, 1'000'000});
  const std::string text = script(report, "samples-per-second");
  EXPECT_THAT(text, HasSubstr("\"AVX2\" 440 400 400 400 400\n"));
  EXPECT_THAT(text, HasSubstr("\"SSE4\" 100 0 0 0 0\n"));
}

TEST(BenchPlots, NothingMeasuredIsNothingToDraw) {
  for (const Plot& plot : plots_of(Report{})) EXPECT_EQ(plot.script, "") << plot.name;
}

}  // namespace
}  // namespace goldthread::bench
