// SPDX-License-Identifier: Apache-2.0
#include "common/volume/volume_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

namespace goldthread {
namespace {

constexpr int kNarrowest = 40;
constexpr int kLabelWidth = 12;
constexpr int kPlotRows = 8;
constexpr int kWidestPlot = 128;

// Text that is drawn in Unicode, or in ASCII where the terminal has no more.
struct Glyphs {
  bool utf8;
  const char* times() const { return utf8 ? " × " : " x "; }
  const char* to() const { return utf8 ? " … " : " to "; }
  const char* arrow() const { return utf8 ? "→" : "->"; }
  const char* corner() const { return utf8 ? "└" : "+"; }
  const char* side() const { return utf8 ? "│" : "|"; }
  const char* tick() const { return utf8 ? "┤" : "+"; }
  const char* floor() const { return utf8 ? "─" : "-"; }
  const char* floor_tick() const { return utf8 ? "┬" : "+"; }
  int steps() const { return utf8 ? 8 : 2; }  ///< heights that one character can show
  const char* bar(int step) const {
    constexpr std::array<const char*, 9> kBlocks{" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
    constexpr std::array<const char*, 3> kAscii{" ", ".", ":"};
    return utf8 ? kBlocks[std::size_t(step)] : kAscii[std::size_t(step)];
  }
};

// Characters of UTF-8 text: bytes that do not continue one.
int width_of(std::string_view text) {
  return int(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

// ASCII in place of the few other characters that this program's own texts use.
std::string plain(const std::string& text) {
  std::string out;
  for (const char letter : text) {
    const auto c = static_cast<unsigned char>(letter);
    out += c < 0x20 || c == 0x7F ? '?' : letter;  // a file's name must not steer the terminal
  }
  return out;
}

std::string ascii(std::string text) {
  constexpr std::array<std::array<std::string_view, 2>, 7> kSpelled{
      {{"×", "x"}, {"…", "..."}, {"→", "->"}, {"“", "\""}, {"”", "\""}, {"−", "-"}, {"³", "^3"}}};
  for (const auto& [from, to] : kSpelled)
    for (std::size_t at; (at = text.find(from)) != std::string::npos;)
      text.replace(at, from.size(), to);
  std::string out;
  for (const char c : text)
    if ((c & 0x80) == 0)
      out += c;
    else if ((c & 0xC0) == 0xC0)
      out += '?';
  return out;
}

// Lines of at most `width` characters, broken at blanks where there are any.
std::vector<std::string> wrapped(std::string_view text, int width) {
  std::vector<std::string> lines;
  std::string line;
  const auto flush = [&] {
    lines.push_back(line);
    line.clear();
  };
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!line.empty() && width_of(line) + 1 + width_of(word) > width) flush();
    if (!line.empty()) line += ' ';
    for (const char c : word) {
      if (width_of(line) >= width && (c & 0xC0) != 0x80) flush();
      line += c;
    }
  }
  if (!line.empty() || lines.empty()) flush();
  return lines;
}

class Report {
 public:
  Report(int columns, bool utf8) : columns_(std::max(columns, kNarrowest)), glyphs_{utf8} {}

  const Glyphs& glyphs() const { return glyphs_; }
  int columns() const { return columns_; }
  void line(const std::string& text) {
    text_.append(text, 0, text.find_last_not_of(' ') + 1);
    text_ += '\n';
  }
  void field(std::string_view label, const std::string& value) {
    const std::string clean = plain(glyphs_.utf8 ? value : ascii(value));
    for (const std::string& part : wrapped(clean, columns_ - kLabelWidth)) {
      line(fmt::format("{:<{}}{}", label, kLabelWidth, part));
      label = "";
    }
  }
  std::string take() { return std::move(text_); }

 private:
  int columns_;
  Glyphs glyphs_;
  std::string text_;
};

std::string bytes_in_words(double bytes) {
  constexpr std::array<const char*, 5> kUnits{"B", "kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  while (bytes >= 1000 && unit + 1 < kUnits.size()) bytes /= 1000, ++unit;
  return fmt::format("{:.{}f} {}", bytes, unit > 0 && bytes < 100 ? 1 : 0, kUnits[unit]);
}

// 12345678 as 12,345,678.
std::string grouped(std::uint64_t number) {
  const std::string digits = std::to_string(number);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

std::string share(double part, double whole) { return fmt::format("{:.3g} %", 100 * part / whole); }

// The way of an axis in a patient's words, or nothing if it is oblique. LPS: x grows to the left, y
// to the back, z to the head.
std::string anatomical(const glm::dvec3& way, const char* arrow) {
  constexpr std::array<const char*, 3> kBelow{"R", "A", "I"}, kAbove{"L", "P", "S"};
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(std::abs(way[axis]) - glm::length(way)) > 1e-6) continue;
    const bool up = way[axis] > 0;
    const auto a = std::size_t(axis);
    return fmt::format("{}{}{}", up ? kBelow[a] : kAbove[a], arrow, up ? kAbove[a] : kBelow[a]);
  }
  return {};
}

void add_direction(Report& report, const glm::dmat3& direction) {
  std::array<std::string, 3> words;
  for (int axis = 0; axis < 3; ++axis)
    words[std::size_t(axis)] = anatomical(direction[axis], report.glyphs().arrow());
  if (std::none_of(words.begin(), words.end(), [](const auto& word) { return word.empty(); })) {
    report.field("direction", fmt::format("i {}, j {}, k {}", words[0], words[1], words[2]));
    return;
  }
  const char* label = "direction";
  for (int row = 0; row < 3; ++row) {
    report.line(fmt::format("{:<{}}{:9.5f}{:9.5f}{:9.5f}", label, kLabelWidth, direction[0][row],
                            direction[1][row], direction[2][row]));
    label = "";
  }
  report.field("", "columns: the ways of i, j and k to the left, back and head");
}

// The extent between the outermost voxels' centres along the world's axes.
void add_extent(Report& report, const VolumeGeometry& geometry) {
  const glm::dmat4 map = geometry.world_from_index();
  glm::dvec3 least(HUGE_VAL), greatest(-HUGE_VAL);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 index(corner & 1 ? geometry.size.x - 1 : 0,
                           corner & 2 ? geometry.size.y - 1 : 0,
                           corner & 4 ? geometry.size.z - 1 : 0);
    const glm::dvec3 world(map * glm::dvec4(index, 1));
    least = glm::min(least, world);
    greatest = glm::max(greatest, world);
  }
  const char* to = report.glyphs().to();
  constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
  const char* label = "extent";
  for (int axis = 0; axis < 3; ++axis) {
    report.field(label, fmt::format("{} {:.6g}{}{:.6g} mm ({:.6g} mm)", kAxes[std::size_t(axis)],
                                    least[axis], to, greatest[axis], greatest[axis] - least[axis]));
    label = "";
  }
}

void add_values(Report& report, const VolumeInfo& info) {
  const std::string held = name_of(info.type);
  std::string type = info.stored_type;
  if (type != held) type += fmt::format(" in the file, {} in memory", held);
  if (info.components > 1)
    type += fmt::format(", component {} of {}", info.component, info.components);
  report.field("type", type);
  const double block = double(Volume::block_bytes(info.geometry, info.type));
  const double voxels = double(info.geometry.voxel_count() * bytes_per_voxel(info.type));
  report.field("memory", fmt::format("{} in columns, for {} of voxels", bytes_in_words(block),
                                     bytes_in_words(voxels)));
  if (info.histogram.empty()) return;
  report.field("range",
               fmt::format("{:.7g}{}{:.7g}", info.minimum, report.glyphs().to(), info.maximum));
  report.field(
      "not finite",
      info.not_finite == 0
          ? "none"
          : fmt::format("{} voxels ({}), shown as empty", grouped(info.not_finite),
                        share(double(info.not_finite), double(info.geometry.voxel_count()))));
}

// Bins gathered into the columns of the plot. Columns are as many as divide the bins evenly, so
// that a flat distribution looks flat.
std::vector<std::uint64_t> plot_columns(const std::vector<std::uint64_t>& histogram, int width) {
  std::size_t columns = histogram.size();
  while (columns > std::size_t(width) && columns % 2 == 0) columns /= 2;
  std::vector<std::uint64_t> counts(columns);
  for (std::size_t bin = 0; bin < histogram.size(); ++bin)
    counts[bin * columns / histogram.size()] += histogram[bin];
  return counts;
}

// The value axis: its line with ticks, and the numbers under the ends and the middle.
void add_value_axis(Report& report, const VolumeInfo& info, int label_width, int columns) {
  const Glyphs& glyphs = report.glyphs();
  std::string axis = std::string(std::size_t(label_width), ' ') + glyphs.corner();
  for (int x = 0; x < columns; ++x)
    axis += x % (columns / 4) == 0 || x == columns - 1 ? glyphs.floor_tick() : glyphs.floor();
  report.line(axis);
  const std::string low = fmt::format("{:.5g}", info.minimum);
  const std::string middle =
      fmt::format("{:.5g}", info.minimum + (info.maximum - info.minimum) / 2);
  const std::string high = fmt::format("{:.5g}", info.maximum);
  std::string numbers(std::size_t(label_width + 1 + columns), ' ');
  numbers.replace(std::size_t(label_width + 1), low.size(), low);
  numbers.replace(std::size_t(label_width + 1 + columns / 2) - middle.size() / 2, middle.size(),
                  middle);
  numbers.replace(numbers.size() - high.size(), high.size(), high);
  report.line(numbers);
}

// Bars on a logarithmic scale from one voxel (the lowest step that shows) to a power of ten.
void add_histogram(Report& report, const VolumeInfo& info) {
  const Glyphs& glyphs = report.glyphs();
  constexpr int kScaleWidth = 7;
  const std::vector<std::uint64_t> counts =
      plot_columns(info.histogram, std::min(report.columns() - kScaleWidth - 1, kWidestPlot));
  const std::uint64_t most = *std::max_element(counts.begin(), counts.end());
  if (most == 0 || info.minimum == info.maximum) return;
  const double decades = std::max(1.0, std::ceil(std::log10(double(most))));
  const int heights = kPlotRows * glyphs.steps();
  const auto height = [&](std::uint64_t count) {
    if (count == 0) return 0;
    return std::max(1, int(std::lround(std::log10(double(count)) / decades * heights)));
  };
  report.line("");
  const std::string title = fmt::format("voxels per {:.3g} of value, on a logarithmic scale",
                                        (info.maximum - info.minimum) / double(counts.size()));
  for (const std::string& part : wrapped(title, report.columns())) report.line(part);
  int last_decade = -1;
  for (int row = kPlotRows - 1; row >= 0; --row) {
    // A row is labelled with the decade that its upper edge reaches, once each.
    const double top = decades * (row + 1) / kPlotRows;
    const int decade = int(std::floor(top + 1e-9));
    const bool labelled = decade != last_decade && top - decade < decades / kPlotRows - 1e-9;
    last_decade = decade;
    std::string text = labelled
                           ? fmt::format("{:>{}}", fmt::format("1e{}", decade), kScaleWidth - 1)
                           : std::string(kScaleWidth - 1, ' ');
    text += ' ';
    text += labelled ? glyphs.tick() : glyphs.side();
    for (const std::uint64_t count : counts)
      text += glyphs.bar(std::clamp(height(count) - row * glyphs.steps(), 0, glyphs.steps()));
    report.line(text);
  }
  add_value_axis(report, info, kScaleWidth, int(counts.size()));
}

}  // namespace

std::string describe(const VolumeInfo& info, int columns, bool utf8) {
  Report report(columns, utf8);
  const VolumeGeometry& geometry = info.geometry;
  const char* times = report.glyphs().times();
  report.field("file", info.file);
  report.field("format", info.format);
  report.field("size",
               fmt::format("{}{}{}{}{} ({} voxels)", geometry.size.x, times, geometry.size.y, times,
                           geometry.size.z, grouped(geometry.voxel_count())));
  report.field("spacing", fmt::format("{:.6g}{}{:.6g}{}{:.6g} mm", geometry.spacing_mm.x, times,
                                      geometry.spacing_mm.y, times, geometry.spacing_mm.z));
  report.field("origin", fmt::format("{:.6g}, {:.6g}, {:.6g} mm (LPS)", geometry.origin_mm.x,
                                     geometry.origin_mm.y, geometry.origin_mm.z));
  add_direction(report, geometry.direction);
  add_extent(report, geometry);
  add_values(report, info);
  for (const std::string& note : info.notes) report.field("note", note);
  if (!info.histogram.empty()) add_histogram(report, info);
  return report.take();
}

}  // namespace goldthread
