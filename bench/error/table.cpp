// SPDX-License-Identifier: Apache-2.0
#include "bench/error/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace goldthread::bench {
namespace {

/// Characters, not bytes: those that continue a UTF-8 sequence take no column.
std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  }));
}

bool is_left(const std::string& head) { return head.starts_with('<'); }

std::string title(const std::string& head) { return is_left(head) ? head.substr(1) : head; }

std::string cell(const std::vector<std::string>& row, std::size_t column) {
  return column < row.size() ? row[column] : std::string();
}

std::string padded(const std::string& text, std::size_t width, bool left) {
  const std::string space(width - std::min(width, columns_of(text)), ' ');
  return left ? text + space : space + text;
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '|') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result;
}

}  // namespace

std::string as_text(const Table& table) {
  std::vector<std::string> titles;
  std::vector<std::size_t> widths;
  for (std::size_t i = 0; i < table.head.size(); ++i) {
    titles.push_back(title(table.head[i]));
    widths.push_back(columns_of(titles.back()));
    for (const auto& row : table.rows) widths[i] = std::max(widths[i], columns_of(cell(row, i)));
  }
  std::string text;
  const auto add = [&](const std::vector<std::string>& row) {
    std::string line;
    for (std::size_t i = 0; i < widths.size(); ++i)
      line += (i > 0 ? "  " : "") + padded(cell(row, i), widths[i], is_left(table.head[i]));
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  };
  add(titles);
  for (const auto& row : table.rows) add(row);
  return text;
}

std::string as_markdown(const Table& table) {
  std::string heads = "|", rules = "|", text;
  for (const std::string& head : table.head) {
    heads += fmt::format(" {} |", escaped(title(head)));
    rules += is_left(head) ? "---|" : "---:|";
  }
  for (const auto& row : table.rows) {
    text += "|";
    for (std::size_t i = 0; i < table.head.size(); ++i)
      text += fmt::format(" {} |", escaped(cell(row, i)));
    text += "\n";
  }
  return heads + "\n" + rules + "\n" + text;
}

std::string number(double value) {
  if (!std::isfinite(value)) return "–";
  const double size = std::abs(value);
  if (size == 0) return "0";
  if (size < 1e-5) return fmt::format("{:.1e}", value);
  // The first digit's place, after rounding to three digits: 9.996 is 10.0.
  const int place = static_cast<int>(std::floor(std::log10(size * (1 + 5e-4))));
  return fmt::format("{:.{}f}", value, std::max(0, 2 - place));
}

std::string milliseconds(double seconds) { return number(1e3 * seconds); }

}  // namespace goldthread::bench
