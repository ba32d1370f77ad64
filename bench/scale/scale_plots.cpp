// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>

#include "bench/error/gnuplot.h"
#include "bench/scale/scale_report.h"

namespace goldthread::bench {
namespace {

/// Okabe and Ito's colours, which colour-blind readers can tell apart; from few pixels to many.
constexpr std::array kColors = {"#E69F00", "#56B4E9", "#009E73", "#CC79A7"};
constexpr int kPoints[] = {5, 7, 9, 13};

std::string style_of(std::size_t size, bool dashed) {
  const std::size_t i = size % kColors.size();
  return fmt::format("with linespoints lw 1.8 ps 0.7 pt {} lc rgb '{}'{}", kPoints[i], kColors[i],
                     dashed ? " dt 2" : "");
}

/// Curves of some points, one for each size.
std::vector<Curve> curves_of(const std::vector<SweepPoint>& points, int view, bool dashed,
                             const std::string& what) {
  std::vector<Curve> curves;
  int before = 0;
  for (const SweepPoint& point : points) {
    if (point.view != view) continue;
    if (point.megapixels != before)
      curves.push_back({fmt::format("{} Mpixel{}", point.megapixels, what),
                        style_of(curves.size(), dashed),
                        {}});
    before = point.megapixels;
    curves.back().points.emplace_back(point.shape.workers, point.frame.efficiency);
  }
  return curves;
}

std::string script(const std::string& name, const std::string& title, const std::string& subtitle,
                   const std::vector<Curve>& curves) {
  return std::string(kFrame) + titled(title, subtitle) +
         "set logscale x 4\nset format x '%g'\nset xlabel 'workers, a core each'\n"
         "set ylabel 'efficiency'\nset yrange [0:1.02]\n" +
         x_range(curves) + data_blocks(curves) + on_both_terminals(name, plot_command(curves));
}

std::string file_name(int view) { return fmt::format("scale-one-master-{}", view + 1); }

}  // namespace

std::vector<Plot> scale_plots(const ScaleReport& report) {
  std::vector<Plot> plots;
  for (int view = 0; view < int(report.views.size()); ++view) {
    const std::string name = file_name(view);
    plots.push_back({name, script(name, "One master", report.views[std::size_t(view)],
                                  curves_of(report.one_level, view, false, ""))});
  }
  auto curves = curves_of(report.with_second_level, 0, false, ", two levels");
  const auto one = curves_of(report.one_level, 0, true, ", one master");
  curves.insert(curves.end(), one.begin(), one.end());
  const std::string name = "scale-two-levels";
  plots.push_back(
      {name, script(name, "One and two levels of masters", report.views.front(), curves)});
  return plots;
}

}  // namespace goldthread::bench
