// SPDX-License-Identifier: Apache-2.0
#include "common/volume/voxel_place.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <string>
#include <string_view>

#include "common/volume/file_names.h"
#include "common/volume/nifti_header.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;

/// No header is longer, and no line of one.
constexpr std::size_t kMostHeader = 1 << 16;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

std::string trimmed(std::string_view text) {
  const auto is_space = [](unsigned char c) { return std::isspace(c) != 0; };
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return std::string(text);
}

/// Lines of "key separator value", keys in lower case.
class TextHeader {
 public:
  /// Reads up to an empty line, or until `last_key` was read; the text must end there.
  TextHeader(const fs::path& file, char separator, const std::string& last_key) {
    std::ifstream stream(file, std::ios::binary);
    std::string text(kMostHeader, '\0');
    stream.read(text.data(), std::streamsize(text.size()));
    text.resize(std::size_t(stream.gcount()));
    for (std::size_t begin = 0; begin < text.size() && !ended_;) {
      const std::size_t newline = text.find('\n', begin);
      if (newline == std::string::npos) return;
      add(trimmed(std::string_view(text).substr(begin, newline - begin)), separator, last_key);
      begin = newline + 1;
      end_ = begin;
    }
  }

  bool ended() const { return ended_; }
  /// Where the header ends, in bytes.
  std::uint64_t end() const { return end_; }
  bool has(const std::string& key) const { return values_.count(key) > 0; }
  std::string operator[](const std::string& key) const {
    const auto found = values_.find(key);
    return found == values_.end() ? "" : found->second;
  }

 private:
  void add(const std::string& line, char separator, const std::string& last_key) {
    if (line.empty()) {
      ended_ = last_key.empty();
      return;
    }
    const std::size_t at = line.find(separator);
    if (line.front() == '#' || at == std::string::npos) return;
    const std::string key = lower(trimmed(std::string_view(line).substr(0, at)));
    values_[key] = trimmed(std::string_view(line).substr(at + 1));
    ended_ = !last_key.empty() && key == last_key;
  }

  std::map<std::string, std::string> values_;
  bool ended_ = false;
  std::uint64_t end_ = 0;
};

std::optional<VoxelPlace> in_nrrd(const fs::path& file, StoredType type) {
  const TextHeader header(file, ':', "");
  const bool plain = lower(header["encoding"]) == "raw" && !header.has("data file") &&
                     !header.has("datafile") && !header.has("line skip") &&
                     !header.has("lineskip") && !header.has("byte skip") && !header.has("byteskip");
  const bool native = bytes_of(type) == 1 || lower(header["endian"]) == "little";
  if (!header.ended() || !plain || !native) return {};
  return VoxelPlace{file, header.end(), type};
}

std::optional<VoxelPlace> in_meta_image(const fs::path& file, StoredType type) {
  const TextHeader header(file, '=', "elementdatafile");
  // As MetaIO reads them: by the first character.
  const auto is_true = [&](const char* key) {
    const std::string value = lower(header[key]);
    return !value.empty() && (value[0] == 't' || value[0] == '1');
  };
  const bool native =
      bytes_of(type) == 1 || !(is_true("binarydatabyteordermsb") || is_true("elementbyteordermsb"));
  if (!header.ended() || !is_true("binarydata") || is_true("compresseddata") ||
      header.has("headersize") || !native)
    return {};
  const std::string data = header["elementdatafile"];
  if (lower(data) == "local") return VoxelPlace{file, header.end(), type};
  // One file beside the header; no list or pattern of files.
  if (data.find_first_of("/\\% ") != std::string::npos || lower(data) == "list") return {};
  return VoxelPlace{file.parent_path() / data, 0, type};
}

std::optional<VoxelPlace> in_nifti(const fs::path& file) {
  const auto header = read_nifti_header(file);
  if (!header || !header->direct() || header->rescaled()) return {};
  return VoxelPlace{file, header->offset, *header->type};
}

std::optional<VoxelPlace> place_in(const fs::path& file, StoredType type) {
  if (has_ending(file, ".raw")) return VoxelPlace{file, 0, type};
  if (has_ending(file, ".nii")) return in_nifti(file);
  if (has_ending(file, ".nrrd")) return in_nrrd(file, type);
  if (has_ending(file, ".mha") || has_ending(file, ".mhd")) return in_meta_image(file, type);
  return {};
}

}  // namespace

std::optional<VoxelPlace> find_voxels(const fs::path& file, const VolumeInfo& info) {
  const auto type = stored_type_named(info.stored_type);
  if (!type || info.components != 1) return {};
  auto place = place_in(file, *type);
  if (!place || held_type(place->type) != info.type) return {};
  std::error_code error;
  const std::uint64_t size = fs::file_size(place->file, error);
  const std::uint64_t bytes = info.geometry.voxel_count() * bytes_of(place->type);
  if (error || size < place->offset || size - place->offset < bytes) return {};
  return place;
}

}  // namespace goldthread
