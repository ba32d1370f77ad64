// SPDX-License-Identifier: Apache-2.0
#pragma once
// A table of words, and its two forms: aligned for a terminal, and Markdown. Pure.

#include <string>
#include <vector>

namespace goldthread::bench {

struct Table {
  std::vector<std::string> head;  ///< a head that begins with '<' is set to the left, without it
  std::vector<std::vector<std::string>> rows;  ///< short rows end in empty cells
};

/// Columns as wide as their widest cell, two spaces apart, numbers to the right.
std::string as_text(const Table& table);
std::string as_markdown(const Table& table);

/// Three significant digits without an exponent where people would write none: "0.0123", "12.3",
/// "1230"; "–" for what is not a number.
std::string number(double value);
/// A time in milliseconds, from seconds.
std::string milliseconds(double seconds);

}  // namespace goldthread::bench
