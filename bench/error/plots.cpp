// SPDX-License-Identifier: Apache-2.0
#include "bench/error/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "bench/error/gnuplot.h"

namespace goldthread::bench {
namespace {

/// Goldthread's solid and filled, VTK's dashed and open, ParaView's a star.
std::string style_of(const std::string& program, Look look) {
  if (program == "Goldthread")
    return fmt::format("with linespoints lc rgb '{}' lw 1.6 pt {} ps 1", color_of(look),
                       point_of(look));
  if (program == "VTK")
    return fmt::format("with linespoints lc rgb '{}' lw 1.2 dt 2 pt {} ps 1", color_of(look),
                       point_of(look) - 1);
  return "with points lc rgb 'black' pt 3 ps 1.6 lw 1.6";
}

using Point = std::pair<double, double> (*)(const MethodRow&);

std::pair<double, double> time_and_error(const MethodRow& row) {
  return {1e3 * row.seconds.median, std::max(row.error.rms, kLeastDrawn)};
}
std::pair<double, double> step_and_error(const MethodRow& row) {
  return {row.step_voxels, std::max(row.error.rms, kLeastDrawn)};
}

/// On a logarithmic axis.
bool is_drawable(const std::pair<double, double>& point) { return point.first > 0; }

/// A curve for each program and look, through its rows with a step of their own. A program that was
/// only measured at its default step gets a point, where `with_defaults`.
std::vector<Curve> curves_of(const Report& report, Point point_from, bool with_defaults) {
  std::vector<Curve> curves;
  for (const char* program : {"Goldthread", "VTK", "ParaView"}) {
    for (const Look look : kLooks) {
      std::vector<MethodRow> rows;
      for (const MethodRow& row : report.methods) {
        const bool shown =
            row.program == program && row.look == look &&
            (row.instruction_set.empty() || row.instruction_set == report.instruction_set);
        const bool placed =
            row.step_voxels > 0 || (with_defaults && row.program != std::string("Goldthread"));
        if (shown && placed && is_drawable(point_from(row))) rows.push_back(row);
      }
      if (rows.empty()) continue;
      std::sort(rows.begin(), rows.end(), [](const MethodRow& a, const MethodRow& b) {
        return a.step_voxels < b.step_voxels;
      });
      Curve curve{fmt::format("{}, {}", program, name_of(look)), style_of(program, look), {}};
      for (const MethodRow& row : rows) curve.points.push_back(point_from(row));
      curves.push_back(std::move(curve));
    }
  }
  return curves;
}

/// Rings around what the programs do unasked.
Curve default_marks(const Report& report) {
  Curve marks{"Goldthread's default step", "with points lc rgb '#444444' pt 6 ps 2.2 lw 1.2", {}};
  for (const MethodRow& row : report.methods) {
    if (row.program == "Goldthread" && row.step_voxels == 0 &&
        row.instruction_set == report.instruction_set && is_drawable(time_and_error(row)))
      marks.points.push_back(time_and_error(row));
  }
  return marks;
}

std::string subtitle_of(const Report& report) {
  return fmt::format("{}×{} pixels, {} threads", report.size.width, report.size.height,
                     report.threads);
}

std::string error_time(const Report& report) {
  std::vector<Curve> curves = curves_of(report, time_and_error, true);
  if (curves.empty()) return {};
  if (Curve marks = default_marks(report); !marks.points.empty()) curves.push_back(marks);
  return kFrame + std::string(kLogLog) +
         titled("Error against time", subtitle_of(report) + ", " + report.instruction_set) +
         "set xtics (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000)\n"
         "set xlabel 'median time of a frame in ms'\n" +
         x_range(curves) + data_blocks(curves) +
         on_both_terminals("error-time", plot_command(curves));
}

std::string error_step(const Report& report) {
  std::vector<Curve> curves = curves_of(report, step_and_error, false);
  if (curves.empty()) return {};
  const auto [step, error] = curves.front().points.back();
  Curve guide{"second order", "with lines lc rgb '#888888' dt 3 lw 1.4", {}};
  for (const double h : {1.0, 1 / 16.0}) guide.points.emplace_back(step * h, 1.6 * error * h * h);
  curves.push_back(guide);
  return kFrame + std::string(kLogLog) +
         titled("Error against step", subtitle_of(report) + ", " + report.instruction_set) +
         "set xtics (0.0625, 0.125, 0.25, 0.5, 1, 2, 4)\nset xlabel 'step in voxels'\n" +
         x_range(curves) + data_blocks(curves) +
         on_both_terminals("error-step", plot_command(curves));
}

/// A group of bars for each instruction set: the bare loop, and the looks at their default step.
std::string samples_per_second(const Report& report) {
  if (report.gathers.empty()) return {};
  std::string data = "$bars << END\n\"\" \"bare gather and lerp\" unlit Phong mip isosurface\n";
  for (const GatherRow& gather : report.gathers) {
    data +=
        fmt::format("\"{}\" {:.6g}", gather.instruction_set, 1e-6 * gather.samples_per_second());
    for (const Look look : kLooks) {
      const MethodRow* row = report.find("Goldthread", look, 0, gather.instruction_set);
      data += fmt::format(" {:.6g}", row ? 1e-6 * row->samples_per_second() : 0.0);
    }
    data += "\n";
  }
  std::string command = "plot ";
  for (int column = 2; column <= 6; ++column)
    command += fmt::format("{}$bars using {}:xtic(1) title columnheader lc rgb '{}'",
                           column > 2 ? ", \\\n     " : "", column,
                           column == 2 ? "#999999" : color_of(kLooks[std::size_t(column - 3)]));
  return kFrame + titled("Samples per second", subtitle_of(report)) +
         "set xtics noenhanced\nset style data histograms\nset style histogram clustered gap 1.5\n"
         "set style fill solid 0.9 noborder\nset boxwidth 0.92\nset yrange [0:*]\n"
         "unset grid\nset grid ytics lt 1 lc rgb '#dddddd' lw 0.5\n"
         "set ylabel 'million samples per second'\n" +
         data + "END\n" + on_both_terminals("samples-per-second", command + "\n");
}

}  // namespace

std::vector<Plot> plots_of(const Report& report) {
  return {{"error-time", error_time(report)},
          {"error-step", error_step(report)},
          {"samples-per-second", samples_per_second(report)},
          {"adaptive-time", adaptive_time(report)},
          {"adaptive-rays", adaptive_rays(report)}};
}

}  // namespace goldthread::bench
