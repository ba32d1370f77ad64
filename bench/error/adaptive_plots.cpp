// SPDX-License-Identifier: Apache-2.0
// Adaptive refinement, as curves.

#include <fmt/format.h>

#include <algorithm>

#include "bench/error/gnuplot.h"
#include "bench/error/plots.h"

namespace goldthread::bench {
namespace {

std::string style(const char* how, Look look, const char* line, int point, double size) {
  return fmt::format("with {} lc rgb '{}' {} pt {} ps {:g}", how, color_of(look), line, point,
                     size);
}

std::pair<double, double> drawable(double x, double error) {
  return {x, std::max(error, kLeastDrawn)};
}

Curve refined_curve(const Report& report, Look look) {
  Curve curve{fmt::format("adaptive, {}", name_of(look)),
              style("linespoints", look, "lw 1.6", point_of(look), 1),
              {}};
  for (const AdaptiveRow& row : report.adaptive.rows)
    if (row.look == look && row.size == report.size)
      curve.points.push_back(drawable(1e3 * row.seconds.median, row.rms));
  return curve;
}

/// Points of pictures of every pixel: ours open, VTK's crossed.
void add_every_pixel(const Report& report, std::vector<Curve>& curves) {
  for (const EveryPixelRow& row : report.adaptive.every_pixel) {
    if (row.size != report.size || row.seconds.median <= 0) continue;
    const bool own = row.program == "Goldthread";
    curves.push_back({fmt::format("{}, {}", own ? "every pixel" : row.program, name_of(row.look)),
                      style("points", row.look, "lw 1.4", own ? point_of(row.look) - 1 : 2, 1.6),
                      {drawable(1e3 * row.seconds.median, row.rms)}});
  }
}

using Measure = double (*)(const CalibrationRow&);

Curve calibration_curve(const Report& report, Look look, const char* what, const char* line,
                        int point, Measure error) {
  Curve curve{
      fmt::format("{}, {}", name_of(look), what), style("linespoints", look, line, point, 0.9), {}};
  for (const CalibrationRow& row : report.adaptive.calibration)
    if (row.look == look) curve.points.push_back(drawable(row.rays_per_pixel, error(row)));
  return curve;
}

std::string subtitle(const Report& report) {
  return fmt::format("{}×{} pixels, {} threads, {}", report.size.width, report.size.height,
                     report.threads, report.instruction_set);
}

}  // namespace

std::string adaptive_time(const Report& report) {
  if (report.adaptive.rows.empty()) return {};
  std::vector<Curve> curves;
  curves.reserve(std::size(kLooks) + 1);
  for (const Look look : kLooks) curves.push_back(refined_curve(report, look));
  add_every_pixel(report, curves);
  return kFrame + std::string(kLogLog) +
         titled("Error against time, from input to picture", subtitle(report)) +
         "set xtics (0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000)\n"
         "set xlabel 'median time in ms'\n" +
         x_range(curves) + data_blocks(curves) +
         on_both_terminals("adaptive-time", plot_command(curves));
}

std::string adaptive_rays(const Report& report) {
  if (report.adaptive.calibration.empty()) return {};
  std::vector<Curve> curves;
  for (const Look look : kLooks) {
    curves.push_back(calibration_curve(report, look, "true", "lw 1.6", point_of(look),
                                       [](const CalibrationRow& row) { return row.rms; }));
    curves.push_back(calibration_curve(report, look, "estimated", "lw 1.2 dt 2", point_of(look) - 1,
                                       [](const CalibrationRow& row) { return row.estimated; }));
  }
  return kFrame + std::string(kLogLog) +
         titled("Error against rays, step by step of refinement", subtitle(report)) +
         "set xtics (0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30, 100)\n"
         "set xlabel 'rays in a pixel, on average'\n" +
         x_range(curves) + data_blocks(curves) +
         on_both_terminals("adaptive-rays", plot_command(curves));
}

}  // namespace goldthread::bench
