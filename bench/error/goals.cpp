// SPDX-License-Identifier: Apache-2.0
// The project's figures, beside what was measured.

#include "bench/error/goals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace goldthread::bench {
namespace {

constexpr double kGoalStep = 0.5;  // voxels

const Seconds* seconds_of(const MethodRow* row) { return row ? &row->seconds : nullptr; }
const Seconds* seconds_of(const LatencyRow* row) { return row ? &row->seconds : nullptr; }

void add_speed_ups(const Report& report, std::vector<Goal>& goals) {
  const auto of = [&](const char* program, Look look) {
    const bool own = std::string(program) == "Goldthread";
    return seconds_of(report.find(program, look, kGoalStep, own ? report.instruction_set : ""));
  };
  const auto against_vtk = [&](std::string what, Look look, double wanted) {
    goals.push_back(
        speed_up(std::move(what), "VTK", of("VTK", look), of("Goldthread", look), wanted));
  };
  against_vtk("every pixel, unlit, step 0.5: frame time", Look::kUnlit, 10);
  against_vtk("the same with Phong shading", Look::kPhong, 20);
  against_vtk("mip", Look::kMip, 10);
  goals.push_back(speed_up("a new isovalue to its finished picture, Phong", "VTK",
                           seconds_of(report.find_latency("new isovalue", "VTK")),
                           seconds_of(report.find_latency("new isovalue", "Goldthread")), 50));
  const std::string beside = "frame beside ParaView's";
  goals.push_back(speed_up("ParaView (pvbatch, 2 ranks): frame time, every pixel", "ParaView",
                           seconds_of(report.find_latency(beside, "ParaView")),
                           seconds_of(report.find_latency(beside, "Goldthread")), 10));
}

void add_errors(const Report& report, std::vector<Goal>& goals) {
  for (const Look look : kLooks) {
    const MethodRow* row = report.find("Goldthread", look, 0, report.instruction_set);
    goals.push_back(at_most(std::string("error at default settings, ") + name_of(look), 0.25,
                            row ? std::optional(row->error.rms) : std::nullopt));
  }
}

void add_kernel(const Report& report, std::vector<Goal>& goals) {
  Goal goal{"samples per second, unlit, to those of a bare gather-and-lerp loop",
            "≥ 0.8",
            "not measured",
            {}};
  const MethodRow* unlit =
      report.find("Goldthread", Look::kUnlit, kGoalStep, report.instruction_set);
  if (unlit != nullptr && !report.gathers.empty() &&
      report.gathers.front().samples_per_second() > 0) {
    const double ratio = unlit->samples_per_second() / report.gathers.front().samples_per_second();
    goal.reached = number(ratio);
    goal.met = ratio >= 0.8;
  }
  goals.push_back(goal);
  const auto ratio_of = [&](const std::string& name) -> std::optional<double> {
    for (const RatioRow& row : report.storages)
      if (row.name == name) return row.by_rounds;
    return {};
  };
  goals.push_back(at_most("uint16 against uint8: slow-down", 1.15, ratio_of("uint16")));
  goals.push_back(at_most("float32 against uint8: slow-down", 1.35, ratio_of("float32")));
}

void add_unused_features(const Report& report, std::vector<Goal>& goals) {
  for (const RatioRow& row : report.features) {
    if (!row.off) continue;
    const double percent = 100 * (row.by_rounds - 1);
    goals.push_back({row.name, "0 ± 1 %",
                     fmt::format("{:+.2f} % ({:+.2f} % by the quickest frames)", percent,
                                 100 * (row.by_minimum - 1)),
                     std::abs(percent) <= 1});
  }
}

}  // namespace

Goal speed_up(std::string what, const std::string& peer, const Seconds* theirs, const Seconds* ours,
              double wanted) {
  Goal goal{std::move(what), fmt::format("{} / {:g}", peer, wanted), "not measured", {}};
  if (theirs == nullptr || ours == nullptr || ours->median <= 0 || ours->minimum <= 0) return goal;
  const double by_median = theirs->median / ours->median;
  goal.reached = fmt::format("{} / {} ({} ms : {} ms); by the quickest frames / {}", peer,
                             number(by_median), milliseconds(theirs->median),
                             milliseconds(ours->median), number(theirs->minimum / ours->minimum));
  goal.met = by_median >= wanted;
  return goal;
}

Goal at_most(std::string what, double wanted, std::optional<double> reached) {
  return {std::move(what), fmt::format("≤ {:g}", wanted),
          reached ? number(*reached) : "not measured",
          reached ? std::optional(*reached <= wanted) : std::nullopt};
}

std::vector<Goal> goals_of(const Report& report) {
  std::vector<Goal> goals;
  add_speed_ups(report, goals);
  add_adaptive_goals(report, goals);
  add_errors(report, goals);
  add_kernel(report, goals);
  add_unused_features(report, goals);
  goals.push_back({"memory of a worker beyond the voxels", "≤ 30 %",
                   fmt::format("{:.1f} %", 100 * report.memory.beyond()),
                   report.memory.beyond() <= 0.30});
  Goal start{"time from start to first picture", "below VTK's", "not measured", {}};
  const LatencyRow* own = report.find_latency("start", "Goldthread");
  const LatencyRow* vtk = report.find_latency("start", "VTK");
  if (own != nullptr && vtk != nullptr) {
    start.reached = fmt::format("{} ms : {} ms", milliseconds(own->seconds.median),
                                milliseconds(vtk->seconds.median));
    start.met = own->seconds.median < vtk->seconds.median;
  }
  goals.push_back(start);
  return goals;
}

}  // namespace goldthread::bench
