// SPDX-License-Identifier: Apache-2.0
#include "bench/motion/motion_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "bench/error/gnuplot.h"
#include "bench/error/json_parts.h"

namespace goldthread::bench {
namespace {

using Json = nlohmann::ordered_json;

/// Okabe and Ito's colours, which colour-blind readers can tell apart.
constexpr std::array kColors = {"#000000", "#E69F00", "#56B4E9", "#009E73", "#CC79A7", "#D55E00"};

Json json_of(const MotionRow& row) {
  return {{"path", row.path},
          {"method", row.method},
          {"meanRms", row.showing.mean_rms()},
          {"percentile95Rms", row.showing.percentile95_rms()},
          {"picturesPerSecond", row.showing.pictures_per_second},
          {"meanLatencySeconds", row.showing.mean_latency()},
          {"seconds", row.showing.seconds},
          {"rms", row.showing.rms},
          {"latencySeconds", row.showing.latency}};
}

std::string subtitle_of(const MotionReport& report) {
  return fmt::format("{}×{} pixels, a full frame in {} ms", report.size.width, report.size.height,
                     number(1e3 * report.cost_factor * report.full_frame_seconds));
}

std::string file_name(std::string path) {
  std::replace(path.begin(), path.end(), ' ', '-');
  return path;
}

std::string plot_script(const MotionReport& report, const std::string& path) {
  std::string data, command;
  std::size_t curves = 0;
  for (const MotionRow& row : report.rows) {
    if (row.path != path) continue;
    data += fmt::format("$curve{} << END\n", curves);
    for (std::size_t i = 0; i < row.showing.seconds.size(); ++i)
      data += fmt::format("{:.4f} {:.4g}\n", row.showing.seconds[i], row.showing.rms[i]);
    data += "END\n";
    command += fmt::format("{}$curve{} with lines lw 1.6 lc rgb '{}' title {} noenhanced",
                           curves > 0 ? ", \\\n     " : "plot ", curves,
                           kColors[curves % kColors.size()], quoted(row.method));
    ++curves;
  }
  return std::string(kFrame) + titled("Error in motion: " + path, subtitle_of(report)) +
         "set xlabel 'seconds'\nset ylabel 'RMS error in 1/255'\nset yrange [0:*]\n" + data +
         on_both_terminals(file_name(path), command + "\n");
}

}  // namespace

Table motion_table(const MotionReport& report) {
  Table table{{"<path", "<method", "RMS mean", "95 %", "pictures/s", "latency ms"}, {}};
  for (const MotionRow& row : report.rows) {
    const Showing& showing = row.showing;
    table.rows.push_back({row.path, row.method, number(showing.mean_rms()),
                          number(showing.percentile95_rms()), number(showing.pictures_per_second),
                          milliseconds(showing.mean_latency())});
  }
  return table;
}

std::vector<std::string> motion_findings(const MotionReport& report) {
  std::vector<std::string> findings;
  for (const auto& [path, about] : report.paths) {
    const MotionRow* best = nullptr;
    const MotionRow* ours = nullptr;
    for (const MotionRow& row : report.rows) {
      if (row.path != path) continue;
      if (row.method == kInterruptible) ours = &row;
      if (best == nullptr || row.showing.mean_rms() < best->showing.mean_rms()) best = &row;
    }
    if (ours == nullptr) continue;
    const double least = best->showing.mean_rms(), own = ours->showing.mean_rms();
    findings.push_back(
        best == ours
            ? fmt::format("{}: {} has the least error, {}", path, ours->method, number(own))
            : fmt::format("{}: the least is {}, {}; {} {} ({} times)", path, number(least),
                          best->method, ours->method, number(own), number(own / least)));
  }
  return findings;
}

std::string motion_markdown(const MotionReport& report) {
  std::string text = fmt::format("goldthread {}, {}; {}, {} threads; {}, {}, {}\n\n",
                                 report.version, report.date, report.machine.processor,
                                 report.threads, report.scene, subtitle_of(report), report.kernel);
  text += as_markdown(motion_table(report)) + "\n";
  for (const std::string& finding : motion_findings(report)) text += "- " + finding + "\n";
  return text;
}

std::string motion_text(const MotionReport& report) {
  std::string text = fmt::format("Error while the camera moves: {}, {}, {} threads, {}\n",
                                 report.scene, subtitle_of(report), report.threads, report.kernel);
  for (const auto& [name, about] : report.paths) text += fmt::format("  {}: {}\n", name, about);
  text += fmt::format("\n{}", as_text(motion_table(report)));
  text += "\n";
  for (const std::string& finding : motion_findings(report)) text += finding + "\n";
  for (const std::string& note : report.notes) text += fmt::format("\n{}\n", note);
  return text;
}

std::string motion_json(const MotionReport& report) {
  Json paths = Json::array(), rows = Json::array();
  for (const auto& [name, about] : report.paths)
    paths.push_back({{"name", name}, {"about", about}});
  for (const MotionRow& row : report.rows) rows.push_back(json_of(row));
  const Json json{{"bench", "motion"},
                  {"version", report.version},
                  {"date", report.date},
                  {"machine", json_of(report.machine)},
                  {"kernel", report.kernel},
                  {"scene", report.scene},
                  {"size", {report.size.width, report.size.height}},
                  {"threads", report.threads},
                  {"fullFrameSeconds", report.full_frame_seconds},
                  {"costFactor", report.cost_factor},
                  {"paths", paths},
                  {"rows", rows},
                  {"notes", report.notes}};
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::vector<Plot> motion_plots(const MotionReport& report) {
  std::vector<Plot> plots;
  for (const auto& [name, about] : report.paths)
    plots.push_back({file_name(name), plot_script(report, name)});
  return plots;
}

}  // namespace goldthread::bench
