// SPDX-License-Identifier: Apache-2.0
#pragma once
// Words of gnuplot that the report's plots share. Pure.

#include <string>
#include <utility>
#include <vector>

#include "bench/error/subject.h"

namespace goldthread::bench {

/// One curve, with its points in the order in which they are joined.
struct Curve {
  std::string title;
  std::string style;
  std::vector<std::pair<double, double>> points;
};

/// Okabe and Ito's colours, which colour-blind readers can tell apart.
const char* color_of(Look look);
int point_of(Look look);

/// Text between gnuplot's single quotes.
std::string quoted(const std::string& text);

extern const char* const kFrame;
/// Both axes logarithmic, y an error. What is smaller than kLeastDrawn is to be drawn there: errors
/// at roundoff would press all others into a corner.
extern const char* const kLogLog;
constexpr double kLeastDrawn = 1e-3;

std::string titled(const std::string& title, const std::string& subtitle);
/// The curves' extent along x, with a little room.
std::string x_range(const std::vector<Curve>& curves);
std::string data_blocks(const std::vector<Curve>& curves);
std::string plot_command(const std::vector<Curve>& curves);
/// Everything twice: as SVG and as PNG.
std::string on_both_terminals(const std::string& name, const std::string& command);

}  // namespace goldthread::bench
