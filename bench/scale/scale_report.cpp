// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/scale_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <set>

namespace goldthread::bench {
namespace {

constexpr double kHalf = 0.5;

std::string percent(double share) { return fmt::format("{:.0f} %", 100 * share); }
std::string efficiency(double value) { return fmt::format("{:.2f}", value); }

std::set<int> sizes_of(const std::vector<SweepPoint>& points) {
  std::set<int> sizes;
  for (const SweepPoint& point : points) sizes.insert(point.megapixels);
  return sizes;
}

/// With one master, ascending by workers.
std::vector<const SweepPoint*> curve_of(const ScaleReport& report, int view, int megapixels) {
  std::vector<const SweepPoint*> curve;
  for (const SweepPoint& point : report.one_level)
    if (point.view == view && point.megapixels == megapixels) curve.push_back(&point);
  return curve;
}

void fit_rows(Table& table, const MeasuredLink& link) {
  const FittedLink fit = fit_link(link);
  const auto add = [&](const char* what, const Affine& cost, double residual) {
    table.rows.push_back({link.name, what, number(cost.us), number(1e3 * cost.us_per_byte),
                          number(cost.at(64)), number(cost.at(65536)), percent(residual)});
  };
  add("sender", fit.costs.send, fit.send_residual);
  add("receiver", fit.costs.receive, fit.receive_residual);
  add("on the way", fit.costs.transit, fit.transit_residual);
}

/// What one quantum takes a master, with its two messages.
double quantum_us(const ClusterModel& model, const MasterCosts& master) {
  constexpr double kSmall = 64;
  return master.done_us + master.supply_us + model.link.send.at(kSmall) +
         model.link.receive.at(kSmall);
}

std::vector<std::string> findings(const ScaleReport& report) {
  std::vector<std::string> found;
  const double us = quantum_us(report.model, report.model.master.back());
  found.push_back(fmt::format(
      "one master takes {} µs for a quantum with its two messages ({} workers), so it deals {} "
      "quanta a second at most",
      number(us), report.model.master.back().workers, number(1e6 / us)));
  double worst = 1;
  for (const ValidationRow& row : report.validation)
    if (std::abs(row.ratio() - 1) > std::abs(worst - 1)) worst = row.ratio();
  found.push_back(fmt::format("simulated over measured time is off 1 by at most {}, at {} clusters",
                              percent(std::abs(worst - 1)), report.validation.size()));
  return found;
}

using Section = std::function<void(const std::string& title, const Table& table)>;

void each_section(const ScaleReport& report, const Section& section) {
  section("Messages: processor time of both sides, and time on the way", link_table(report));
  section("What a master and a compositor compute", master_table(report));
  section("Simulated against real clusters in threads of this process", validation_table(report));
  for (int view = 0; view < int(report.views.size()); ++view)
    section("Efficiency with one master: " + report.views[std::size_t(view)],
            efficiency_table(report, view));
  section("Where one master saturates (tiles of 64×64 pixels)", saturation_table(report));
  section(fmt::format("A second level of masters for {} workers", kMostWorkers),
          second_level_table(report));
}

std::string head_of(const ScaleReport& report) {
  return fmt::format("goldthread {}, {}; {}, {} cores; {}, recorded with {}×{} pixels, {}",
                     report.version, report.date, report.machine.processor, report.machine.cores,
                     report.scene, report.recorded_size.width, report.recorded_size.height,
                     report.kernel);
}

}  // namespace

Table link_table(const ScaleReport& report) {
  Table table{{"<ranks", "<side", "µs", "ns/byte", "64 B µs", "64 KiB µs", "off by ≤"}, {}};
  for (const MeasuredLink& link : report.links) fit_rows(table, link);
  return table;
}

Table master_table(const ScaleReport& report) {
  Table table{{"<role", "workers", "tile done µs", "quantum µs", "queue µs/tile", "view µs/worker"},
              {}};
  for (const MasterCosts& costs : report.model.master)
    table.rows.push_back({"master", std::to_string(costs.workers), number(costs.done_us),
                          number(costs.supply_us), number(costs.queue_us), number(costs.begin_us)});
  table.rows.push_back(
      {fmt::format("compositor: {} µs and {} ns a byte for a tile's samples",
                   number(report.model.place.us), number(1e3 * report.model.place.us_per_byte))});
  return table;
}

Table validation_table(const ScaleReport& report) {
  Table table{{"<rays", "<work", "workers", "measured ms", "simulated ms", "ratio"}, {}};
  for (const ValidationRow& row : report.validation)
    table.rows.push_back({row.rays, row.work, std::to_string(row.workers),
                          number(1e-3 * row.measured_us), number(1e-3 * row.simulated_us),
                          efficiency(row.ratio())});
  return table;
}

Table efficiency_table(const ScaleReport& report, int view) {
  Table table{{"workers"}, {}};
  for (const int size : sizes_of(report.one_level)) {
    table.head.push_back(fmt::format("{} Mpixel", size));
    table.head.push_back("ms");
    const auto curve = curve_of(report, view, size);
    table.rows.resize(std::max(table.rows.size(), curve.size()));
    for (std::size_t i = 0; i < curve.size(); ++i) {
      auto& row = table.rows[i];
      if (row.empty()) row.push_back(std::to_string(curve[i]->shape.workers));
      row.push_back(efficiency(curve[i]->frame.efficiency));
      row.push_back(number(1e-3 * curve[i]->frame.us));
    }
  }
  return table;
}

Table saturation_table(const ScaleReport& report) {
  Table table{{"<view", "Mpixel", "tiles", "tile ms", "one master feeds", "below ½ from", "<why",
               "at 4096", "master busy", "compositors busy"},
              {}};
  for (int view = 0; view < int(report.views.size()); ++view)
    for (const int size : sizes_of(report.one_level)) {
      const auto curve = curve_of(report, view, size);
      const SweepPoint& last = *curve.back();
      const auto below = std::find_if(curve.begin(), curve.end(), [](const SweepPoint* point) {
        return point->frame.efficiency < kHalf;
      });
      const double feeds =
          last.tile_us / quantum_us(report.model, report.model.master_of(last.shape.workers));
      table.rows.push_back({report.views[std::size_t(view)], std::to_string(size),
                            std::to_string(last.tiles), number(1e-3 * last.tile_us), number(feeds),
                            below == curve.end() ? "–" : std::to_string((*below)->shape.workers),
                            below == curve.end() ? "" : limit_of(**below),
                            efficiency(last.frame.efficiency), percent(last.frame.master_busy),
                            percent(last.frame.compositor_busy)});
    }
  return table;
}

Table second_level_table(const ScaleReport& report) {
  Table table{{"<view", "Mpixel", "one master", "sub-masters", "workers each", "tile px",
               "tiles/chunk", "efficiency", "ms", "<limit", "messages/s", "top messages/s"},
              {}};
  for (int view = 0; view < int(report.views.size()); ++view)
    for (const int size : sizes_of(report.two_levels)) {
      const SweepPoint* plan = second_level(report.two_levels, view, size, kGoal);
      if (plan == nullptr) continue;
      double one = 0;
      for (const SweepPoint& point : report.two_levels)
        if (point.view == view && point.megapixels == size && point.shape.masters == 1)
          one = std::max(one, point.frame.efficiency);
      table.rows.push_back(
          {report.views[std::size_t(view)], std::to_string(size), efficiency(one),
           std::to_string(plan->shape.masters),
           std::to_string(plan->shape.workers / plan->shape.masters), std::to_string(plan->tile_px),
           std::to_string(plan->shape.tiles_per_chunk), efficiency(plan->frame.efficiency),
           number(1e-3 * plan->frame.us), plan->frame.efficiency >= kGoal ? "" : limit_of(*plan),
           number(plan->frame.most_messages),
           number(1e6 * double(plan->frame.top_messages) / plan->frame.us)});
    }
  return table;
}

std::string scale_text(const ScaleReport& report) {
  std::string text = head_of(report) + "\n";
  each_section(report, [&](const std::string& title, const Table& table) {
    text += fmt::format("\n{}\n{}", title, as_text(table));
  });
  text += "\n";
  for (const std::string& finding : findings(report)) text += finding + "\n";
  for (const std::string& note : report.notes) text += note + "\n";
  return text;
}

std::string scale_markdown(const ScaleReport& report) {
  std::string text = head_of(report) + "\n";
  each_section(report, [&](const std::string& title, const Table& table) {
    text += fmt::format("\n**{}**\n\n{}", title, as_markdown(table));
  });
  text += "\n";
  for (const std::string& finding : findings(report)) text += "- " + finding + "\n";
  for (const std::string& note : report.notes) text += "- " + note + "\n";
  return text;
}

}  // namespace goldthread::bench
