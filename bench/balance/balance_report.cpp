// SPDX-License-Identifier: Apache-2.0
#include "bench/balance/balance_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>

#include "bench/error/gnuplot.h"
#include "bench/error/json_parts.h"

namespace goldthread::bench {
namespace {

using Json = nlohmann::ordered_json;
/// A picture on this machine, or the replay with so many workers.
using Figure = std::map<std::pair<bool, int>, std::vector<const RateRow*>>;

/// Okabe and Ito's colours, which colour-blind readers can tell apart.
constexpr std::array kColors = {"#999999", "#E69F00", "#56B4E9", "#0072B2",
                                "#009E73", "#CC79A7", "#D55E00", "#000000"};

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

Figure figures_of(const BalanceReport& report) {
  Figure figures;
  for (const RateRow& row : report.rates) figures[{row.replayed, row.workers}].push_back(&row);
  return figures;
}

std::string about(const std::pair<bool, int>& figure) {
  return figure.first ? fmt::format("replayed, {} workers", figure.second)
                      : fmt::format("on this machine, {} workers", figure.second);
}

Section rate_section(const BalanceReport& report, const std::pair<bool, int>& figure,
                     const std::vector<const RateRow*>& rows) {
  Section section{fmt::format("Frames a second, {}", about(figure)),
                  "By the distance of the camera, in that of the scene.",
                  {{"<method"}, {}}};
  for (const double distance : report.distances) section.table.head.push_back(number(distance));
  for (const RateRow* row : rows) {
    std::vector<std::string> cells{row->method};
    for (const double rate : row->frames_per_second) cells.push_back(number(rate));
    section.table.rows.push_back(std::move(cells));
  }
  return section;
}

std::string head_of(const BalanceReport& report) {
  return fmt::format("goldthread {}, {}; {}, {} cores; {}, {}×{} pixels, medians of {} frames{}",
                     report.version, report.date, report.machine.processor, report.machine.cores,
                     report.scene, report.size.width, report.size.height, report.repeats,
                     report.quick ? ", quick" : "");
}

Plot plot_of(const BalanceReport& report, const std::pair<bool, int>& figure,
             const std::vector<const RateRow*>& rows) {
  std::vector<Curve> curves;
  for (const RateRow* row : rows) {
    const std::size_t i = curves.size();
    Curve curve{row->method,
                fmt::format("with linespoints lw {} pt {} ps 0.7 lc rgb '{}'",
                            row == rows.back() ? 2.4 : 1.6, 4 + i, kColors[i % kColors.size()]),
                {}};
    for (std::size_t d = 0; d < report.distances.size(); ++d)
      curve.points.emplace_back(report.distances[d], row->frames_per_second[d]);
    curves.push_back(std::move(curve));
  }
  const std::string name =
      figure.first ? fmt::format("figure-9-{}-workers", figure.second) : "figure-9-measured";
  return {name, std::string(kFrame) + titled("Frame rate and distance", about(figure)) +
                    "set key below Left reverse maxrows 4\nset logscale x 2\nset logscale y\n" +
                    "set xlabel 'distance of the camera (1: that of the scene)'\n"
                    "set ylabel 'frames a second'\n" +
                    x_range(curves) + data_blocks(curves) +
                    on_both_terminals(name, plot_command(curves))};
}

}  // namespace

std::vector<Goal> balance_goals(const BalanceReport& report) {
  std::vector<Goal> goals;
  const auto balanced = [&](const std::string& how, const std::string& what, double reached) {
    goals.push_back({fmt::format("imbalance of 4 workers, {}, {}", what, how),
                     "≤ " + percent(kGoalImbalance), percent(reached), reached <= kGoalImbalance});
  };
  for (const ImbalanceRow& row : report.imbalances) {
    balanced("as it ran here", row.what, row.measured);
    balanced("a core for each (replayed)", row.what, row.replayed);
  }
  for (const GainRow& row : report.gains) {
    if (row.tiles != kGoalTilesPerWorker * std::size_t(row.workers)) continue;
    goals.push_back({fmt::format("descending cost over screen order, {} tiles, {} workers",
                                 row.tiles, row.workers),
                     "≥ " + percent(kGoalGain), percent(row.median), row.median >= kGoalGain});
  }
  return goals;
}

std::vector<Section> balance_sections(const BalanceReport& report) {
  Section goals{"Goals", "", {{"<goal", "<wanted", "<measured", "<reached"}, {}}};
  for (const Goal& goal : balance_goals(report))
    goals.table.rows.push_back(
        {goal.what, goal.goal, goal.reached, goal.met.value_or(false) ? "yes" : "MISSED"});
  std::vector<Section> sections{goals};
  for (const auto& [figure, rows] : figures_of(report))
    sections.push_back(rate_section(report, figure, rows));

  Section gains{"What descending cost gains over screen order",
                "The same frames replayed in both orders, at all distances.",
                {{"tiles", "workers", "least", "median", "most"}, {}}};
  for (const GainRow& row : report.gains)
    gains.table.rows.push_back({std::to_string(row.tiles), std::to_string(row.workers),
                                percent(row.least), percent(row.median), percent(row.most)});
  sections.push_back(gains);

  Section imbalances{"Imbalance of four workers",
                     "Processor time, max / mean − 1. Replayed: what the tiles cost, handed out by "
                     "the same scheduler to four workers with a core each.",
                     {{"<picture", "as it ran here", "replayed"}, {}}};
  for (const ImbalanceRow& row : report.imbalances)
    imbalances.table.rows.push_back({row.what, percent(row.measured), percent(row.replayed)});
  sections.push_back(imbalances);

  Section predictions{"How well the last frame foretells the next",
                      "Σ|predicted − actual| / Σ actual over tiles of 64×64 pixels.",
                      {{"<camera", "costs as they were", "re-projected"}, {}}};
  for (const PredictionRow& row : report.predictions)
    predictions.table.rows.push_back({row.path, percent(row.as_it_was), percent(row.reprojected)});
  sections.push_back(predictions);
  return sections;
}

std::string balance_text(const BalanceReport& report) {
  std::string text = "Load balance: " + head_of(report) + "\n";
  for (const Section& section : balance_sections(report)) {
    text += fmt::format("\n{}\n", section.title);
    if (!section.note.empty()) text += section.note + "\n";
    text += as_text(section.table);
  }
  for (const std::string& note : report.notes) text += fmt::format("\n{}\n", note);
  return text;
}

std::string balance_markdown(const BalanceReport& report) {
  std::string text = head_of(report) + "\n";
  for (const Section& section : balance_sections(report)) {
    text += fmt::format("\n**{}.** {}\n\n", section.title, section.note);
    text += as_markdown(section.table);
  }
  return text;
}

std::string balance_json(const BalanceReport& report) {
  Json rates = Json::array(), gains = Json::array(), imbalances = Json::array(),
       predictions = Json::array(), goals = Json::array();
  for (const RateRow& row : report.rates)
    rates.push_back({{"method", row.method},
                     {"workers", row.workers},
                     {"replayed", row.replayed},
                     {"framesPerSecond", row.frames_per_second}});
  for (const GainRow& row : report.gains)
    gains.push_back({{"tiles", row.tiles},
                     {"workers", row.workers},
                     {"least", row.least},
                     {"median", row.median},
                     {"most", row.most}});
  for (const ImbalanceRow& row : report.imbalances)
    imbalances.push_back(
        {{"picture", row.what}, {"measured", row.measured}, {"replayed", row.replayed}});
  for (const PredictionRow& row : report.predictions)
    predictions.push_back(
        {{"camera", row.path}, {"asItWas", row.as_it_was}, {"reprojected", row.reprojected}});
  for (const Goal& goal : balance_goals(report)) goals.push_back(json_of(goal));
  const Json json{{"bench", "balance"},
                  {"version", report.version},
                  {"date", report.date},
                  {"machine", json_of(report.machine)},
                  {"scene", report.scene},
                  {"size", {report.size.width, report.size.height}},
                  {"quick", report.quick},
                  {"repeats", report.repeats},
                  {"distances", report.distances},
                  {"rates", rates},
                  {"gains", gains},
                  {"imbalances", imbalances},
                  {"predictions", predictions},
                  {"goals", goals},
                  {"notes", report.notes}};
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::vector<Plot> balance_plots(const BalanceReport& report) {
  std::vector<Plot> plots;
  for (const auto& [figure, rows] : figures_of(report))
    plots.push_back(plot_of(report, figure, rows));
  return plots;
}

}  // namespace goldthread::bench
