// SPDX-License-Identifier: Apache-2.0
#include "common/volume/file_names.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string>

#include "common/volume/volume_checks.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestHeader = std::size_t(1) << 20;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Runs of digits compare as numbers, anything else as characters.
bool before_by_number(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (j < b.size() && b[j] == '0') ++j;
    std::size_t end_a = i, end_b = j;
    while (end_a < a.size() && is_digit(a[end_a])) ++end_a;
    while (end_b < b.size() && is_digit(b[end_b])) ++end_b;
    if (end_a - i != end_b - j) return end_a - i < end_b - j;
    if (const int order = a.compare(i, end_a - i, b, j, end_b - j)) return order < 0;
    i = end_a, j = end_b;
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r");
  return first == std::string::npos
             ? std::string()
             : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// What a text header gives for one of `keys`, without the blanks around it.
std::optional<std::string> header_value(const fs::path& file, char separator,
                                        const std::array<std::string_view, 2>& keys) {
  std::ifstream stream(file, std::ios::binary);
  std::string line;
  for (std::size_t read = 0; read < kLongestHeader && std::getline(stream, line);
       read += line.size() + 1) {
    const auto at = line.find(separator);
    if (at == std::string::npos) continue;
    const std::string key = trimmed(lower(line.substr(0, at)));
    if (key == keys[0] || key == keys[1]) return trimmed(line.substr(at + 1));
  }
  return std::nullopt;
}

Result<std::optional<std::uint64_t>> named_file_bytes(const fs::path& header,
                                                      const std::optional<std::string>& value) {
  // A list or a numbered pattern; or none at all, which the format's reader then refuses.
  if (!value || value->empty() || value->find('%') != std::string::npos ||
      lower(*value).starts_with("list"))
    return std::optional<std::uint64_t>();
  std::error_code error;
  const std::uint64_t own = fs::file_size(header, error);
  if (lower(*value) == "local") return std::optional(own);
  const fs::path data = header.parent_path() / *value;
  const std::uint64_t bytes = fs::file_size(data, error);
  if (error)
    return failure_of(header, "the file of its voxels, " + *value + ", cannot be read",
                      "keep both files together");
  return std::optional(bytes);
}

Result<std::optional<std::uint64_t>> image_file_bytes(const fs::path& header) {
  std::error_code error;
  for (const char* ending : {".img", ".img.gz", ".IMG"}) {
    const std::uint64_t bytes = fs::file_size(fs::path(header).replace_extension(ending), error);
    if (!error) return std::optional(bytes);
  }
  return failure_of(header, "the .img file of its voxels is not there", "keep both files together");
}

}  // namespace

bool has_ending(const fs::path& file, std::string_view ending) {
  return lower(file.filename().string()).ends_with(ending);
}

std::vector<fs::path> numbered_files(const fs::path& folder,
                                     const std::array<const char*, 4>& endings) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    std::error_code ignored;
    const bool wanted = std::any_of(endings.begin(), endings.end(), [&](const char* ending) {
      return ending && has_ending(entry.path(), ending);
    });
    if (wanted && entry.is_regular_file(ignored)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return before_by_number(a.filename().string(), b.filename().string());
  });
  return files;
}

Result<std::optional<std::uint64_t>> data_file_bytes(const fs::path& file) {
  if (has_ending(file, ".mhd") || has_ending(file, ".mha"))
    return named_file_bytes(file, header_value(file, '=', {"elementdatafile", "elementdatafile"}));
  if (has_ending(file, ".nhdr"))
    return named_file_bytes(file, header_value(file, ':', {"data file", "datafile"}));
  if (has_ending(file, ".hdr")) return image_file_bytes(file);
  std::error_code error;
  const std::uint64_t bytes = fs::file_size(file, error);
  if (error) return failure_of(file, "it cannot be read: " + error.message(), "check the path");
  return std::optional(bytes);
}

}  // namespace goldthread
