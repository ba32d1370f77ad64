// SPDX-License-Identifier: Apache-2.0
// VOL2's three figures as gnuplot scripts.

#include <fmt/format.h>

#include <map>

#include "bench/error/gnuplot.h"
#include "bench/throughput/throughput_report.h"

namespace goldthread::bench {
namespace {

/// Okabe and Ito's colours, which colour-blind readers can tell apart.
const char* color_of(Carrier carrier) {
  switch (carrier) {
    case Carrier::kSharedMemory:
      return "#0072B2";
    case Carrier::kTcp:
      return "#D55E00";
    case Carrier::kThreads:
      return "#009E73";
  }
  return "black";
}

std::string solid(const char* color, int point) {
  return fmt::format("with linespoints lc rgb '{}' lw 1.6 pt {} ps 1", color, point);
}
std::string dashed(const char* color) {
  return fmt::format("with linespoints lc rgb '{}' lw 1.2 dt 2 pt 6 ps 1", color);
}

/// Curves by title, in the order in which they were begun.
class Curves {
 public:
  void add(const std::string& title, const std::string& style, double x, double y) {
    if (!(y > 0)) return;
    const auto [place, is_new] = places_.emplace(title, curves_.size());
    if (is_new) curves_.push_back({title, style, {}});
    curves_[place->second].points.emplace_back(x, y);
  }
  const std::vector<Curve>& all() const { return curves_; }

 private:
  std::map<std::string, std::size_t> places_;
  std::vector<Curve> curves_;
};

std::string script_of(const std::string& name, const std::string& title,
                      const std::string& subtitle, const std::string& axes, const Curves& curves) {
  if (curves.all().empty()) return {};
  return std::string(kFrame) + titled(title, subtitle) + "set logscale xy\nset format y '%g'\n" +
         axes + x_range(curves.all()) + data_blocks(curves.all()) +
         on_both_terminals(name, plot_command(curves.all()));
}

constexpr const char* kSides =
    "set xtics (128, 256, 512, 1024, 2048, 4096)\nset xlabel 'pixels a side, one ray in each'\n"
    "set ylabel 'frames per second'\n";

Plot bypassed_plot(const ThroughputReport& report) {
  Curves curves;
  for (const FramesRow& row : report.bypassed) {
    const Carrier carrier = row.setup.carrier;
    const double side = row.setup.size.width;
    curves.add(name_of(carrier), solid(color_of(carrier), 7), side, row.frames_per_second());
    if (row.stream && row.frames.sample_bytes > 0)
      curves.add(fmt::format("{}, without Goldthread", name_of(carrier)), dashed(color_of(carrier)),
                 side, row.stream->bytes_per_second() / row.frames.sample_bytes);
  }
  const char* const name = "everything-bypassed";
  return {name, script_of(name, "Everything by-passed", "as VOL2's figure 4; one worker", kSides,
                          curves)};
}

Plot master_plot(const ThroughputReport& report) {
  Curves curves;
  for (const FramesRow& row : report.master) {
    const std::string tiles =
        fmt::format("{} tiles, {}", row.frames.tiles, name_of(row.setup.carrier));
    const int point = row.setup.tile_px < 64 ? 5 : 7;
    curves.add(tiles, solid(color_of(row.setup.carrier), point), row.setup.workers,
               row.frames_per_second());
  }
  const char* const name = "master-alone";
  return {name, script_of(name, "Everything by-passed but the master", "as VOL2's figure 5",
                          "set xtics (1, 2, 4, 8, 16, 32)\nset xlabel 'workers'\n"
                          "set ylabel 'frames per second'\n",
                          curves)};
}

Plot back_end_plot(const ThroughputReport& report) {
  Curves curves;
  for (const FramesRow& row : report.back_end) {
    const double side = row.setup.size.width;
    const std::string which = name_of(row.setup.carrier);
    const char* const color = color_of(row.setup.carrier);
    curves.add(which + ", JPEG", solid(color, 7), side, row.frames_per_second());
    curves.add(which + ", lossless", dashed(color), side, row.lossless_per_second());
  }
  const char* const name = "back-end-alone";
  return {name, script_of(name, "Everything by-passed but the compositor", "as VOL2's figure 6",
                          kSides, curves)};
}

}  // namespace

std::vector<Plot> throughput_plots(const ThroughputReport& report) {
  return {bypassed_plot(report), master_plot(report), back_end_plot(report)};
}

}  // namespace goldthread::bench
