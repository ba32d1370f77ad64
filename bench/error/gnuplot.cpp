// SPDX-License-Identifier: Apache-2.0
#include "bench/error/gnuplot.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace goldthread::bench {

const char* const kFrame =
    "set encoding utf8\n"
    "set border 3 lc rgb '#444444'\n"
    "set tics nomirror out textcolor rgb '#222222'\n"
    "set grid xtics ytics lt 1 lc rgb '#dddddd' lw 0.5\n"
    "set key outside right center Left reverse samplen 2 spacing 1.25\n";

const char* const kLogLog =
    "set logscale xy\n"
    "set format y '%g'\n"
    "set yrange [7e-4:*]\n"
    "set ylabel 'RMS error in 1/255 (what is below 0.001 is drawn there)'\n";

const char* color_of(Look look) {
  switch (look) {
    case Look::kUnlit:
      return "#0072B2";
    case Look::kPhong:
      return "#D55E00";
    case Look::kMip:
      return "#009E73";
    case Look::kIsosurface:
      return "#CC79A7";
  }
  return "black";
}

int point_of(Look look) {
  constexpr int kPoints[] = {7, 5, 9, 13};
  return kPoints[static_cast<int>(look)];
}

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    result += c == '\n' ? ' ' : c;
  }
  return result + "'";
}

std::string data_blocks(const std::vector<Curve>& curves) {
  std::string text;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    text += fmt::format("$curve{} << END\n", i);
    for (const auto& [x, y] : curves[i].points) text += fmt::format("{:.9g} {:.9g}\n", x, y);
    text += "END\n";
  }
  return text;
}

std::string plot_command(const std::vector<Curve>& curves) {
  std::string text = "plot ";
  for (std::size_t i = 0; i < curves.size(); ++i)
    text += fmt::format("{}$curve{} {} title {} noenhanced", i > 0 ? ", \\\n     " : "", i,
                        curves[i].style, quoted(curves[i].title));
  return text + "\n";
}

std::string on_both_terminals(const std::string& name, const std::string& command) {
  return fmt::format(
      "set terminal svg size 880,560 font 'sans,13' linewidth 1.3 background 'white'\n"
      "set output '{0}.svg'\n{1}"
      "set terminal pngcairo size 1760,1120 font 'sans,24' linewidth 2.6 pointscale 1.8\n"
      "set output '{0}.png'\n{1}"
      "unset output\n",
      name, command);
}

std::string titled(const std::string& title, const std::string& subtitle) {
  return "set title " + quoted(title + " (" + subtitle + ")") + " noenhanced\n";
}

std::string x_range(const std::vector<Curve>& curves) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const Curve& curve : curves) {
    for (const auto& point : curve.points) {
      low = std::min(low, point.first);
      high = std::max(high, point.first);
    }
  }
  return fmt::format("set xrange [{:.6g}:{:.6g}]\n", low / 1.3, high * 1.3);
}

}  // namespace goldthread::bench
