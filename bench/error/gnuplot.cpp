// SPDX-License-Identifier: Apache-2.0
#include "bench/error/gnuplot.h"

#include <fmt/format.h>

#include <chrono>

#include "bench/error/process.h"
#include "common/image/whole_file.h"

namespace goldthread::bench {
namespace {

constexpr std::chrono::seconds kPlotPatience{60};

}  // namespace

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    result += c == '\n' ? ' ' : c;
  }
  return result + "'";
}

std::string plot_frame() {
  return "set encoding utf8\n"
         "set border 3 lc rgb '#444444'\n"
         "set tics nomirror out textcolor rgb '#222222'\n"
         "set grid xtics ytics lt 1 lc rgb '#dddddd' lw 0.5\n"
         "set key outside right center Left reverse samplen 2 spacing 1.25\n";
}

std::string titled(const std::string& title, const std::string& subtitle) {
  return "set title " + quoted(title + " (" + subtitle + ")") + " noenhanced\n";
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

void write_text(const std::filesystem::path& file, const std::string& text) {
  write_whole_file(file, {reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

std::string draw(const Plot& plot, const std::filesystem::path& folder) {
  if (plot.script.empty()) return {};
  const std::string script = plot.name + ".gp";
  write_text(folder / script, plot.script);
  try {
    ChildProcess gnuplot({"env", "-C", folder.string(), "gnuplot", script}, folder / "gnuplot.log");
    gnuplot.wait(kPlotPatience);
    return {};
  } catch (const PeerFailure& failure) {
    return failure.what();
  }
}

}  // namespace goldthread::bench
