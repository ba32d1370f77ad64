// SPDX-License-Identifier: Apache-2.0
#include "common/volume/file_names.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <initializer_list>
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

// A field of a text header.
struct HeaderField {
  std::string value;  // without the blanks around it
  std::uint64_t end;  // where the next line begins
};

// The first line whose part before `separator` is one of `keys`.
std::optional<HeaderField> header_field(const fs::path& file, char separator,
                                        std::initializer_list<std::string_view> keys) {
  std::ifstream stream(file, std::ios::binary);
  std::string line;
  for (std::uint64_t read = 0; read < kLongestHeader && std::getline(stream, line);) {
    read += line.size() + 1;
    const auto at = std::min(line.find(separator), line.size());
    const std::string key = trimmed(lower(line.substr(0, at)));
    if (std::find(keys.begin(), keys.end(), key) != keys.end())
      return HeaderField{trimmed(line.substr(std::min(at + 1, line.size()))), read};
  }
  return std::nullopt;
}

using Available = Result<std::optional<DataBytes>>;

Available bytes_beyond(const fs::path& file, std::uint64_t header, bool compressed) {
  std::error_code error;
  const std::uint64_t bytes = fs::file_size(file, error);
  if (error) return failure_of(file, "it cannot be read: " + error.message(), "check the path");
  return std::optional(DataBytes{bytes - std::min(bytes, header), compressed});
}

bool is_gzip(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return stream.get() == 0x1f && stream.get() == 0x8b;
}

// Of a text header that names its file of voxels in `field`, or is followed by them ("LOCAL").
Available named_data(const fs::path& header, const std::optional<HeaderField>& field,
                     bool compressed) {
  // A list or a numbered pattern; or none at all, which the format's reader then refuses.
  if (!field || field->value.empty() || field->value.find('%') != std::string::npos ||
      lower(field->value).starts_with("list"))
    return std::optional<DataBytes>();
  if (lower(field->value) == "local") return bytes_beyond(header, field->end, compressed);
  const fs::path data = header.parent_path() / field->value;
  std::error_code error;
  if (!fs::is_regular_file(data, error))
    return failure_of(header, "the file of its voxels, " + field->value + ", is not there",
                      "keep both files together");
  return bytes_beyond(data, 0, compressed);
}

Available metaimage_data(const fs::path& file) {
  const auto compressed = header_field(file, '=', {"compresseddata"});
  return named_data(file, header_field(file, '=', {"elementdatafile"}),
                    compressed && lower(compressed->value) != "false");
}

Available nifti_pair_data(const fs::path& header) {
  std::error_code error;
  for (const char* ending : {".img", ".img.gz", ".IMG"})
    if (const fs::path image = fs::path(header).replace_extension(ending);
        fs::is_regular_file(image, error))
      return bytes_beyond(image, 0, is_gzip(image));
  return failure_of(header, "the .img file of its voxels is not there", "keep both files together");
}

Available vtk_data(const fs::path& file) {
  const bool binary = header_field(file, ' ', {"binary"}).has_value();
  const auto last =
      header_field(file, ' ', {"lookup_table", "color_scalars", "vectors", "normals", "tensors"});
  return bytes_beyond(file, last ? last->end : 0, !binary);
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

Result<std::optional<DataBytes>> data_bytes_of(const fs::path& file) {
  if (has_ending(file, ".mhd") || has_ending(file, ".mha")) return metaimage_data(file);
  if (has_ending(file, ".nhdr"))
    return named_data(file, header_field(file, ':', {"data file", "datafile"}), true);
  if (has_ending(file, ".hdr")) return nifti_pair_data(file);
  if (has_ending(file, ".vtk")) return vtk_data(file);
  const bool plain = (has_ending(file, ".nii") || has_ending(file, ".img")) && !is_gzip(file);
  return bytes_beyond(file, 0, !plain);
}

}  // namespace goldthread
