// SPDX-License-Identifier: Apache-2.0
#include "common/volume/raw_volume.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <fstream>
#include <limits>
#include <string_view>

#include "common/volume/volume_checks.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little,
              "raw files are read as they lie in memory");

constexpr std::size_t kChunk = std::size_t(1) << 24;

struct RawShape {
  std::optional<FileSize3> size;
  std::optional<glm::dvec3> spacing_mm;
  std::optional<StoredType> type;
};

// Three numbers with an x between them, and nothing else.
template <class T>
std::optional<std::array<T, 3>> triple(std::string_view text) {
  std::array<T, 3> numbers{};
  const char* at = text.data();
  const char* end = at + text.size();
  for (std::size_t i = 0; i < 3; ++i) {
    if (i > 0 && (at == end || *at++ != 'x')) return std::nullopt;
    const auto [next, error] = std::from_chars(at, end, numbers[i]);
    if (error != std::errc{}) return std::nullopt;
    at = next;
  }
  return at == end ? std::optional(numbers) : std::nullopt;
}

RawShape shape_of(const std::string& stem) {
  RawShape shape;
  for (std::size_t begin = 0; begin <= stem.size();) {
    const std::size_t end = std::min(stem.find('_', begin), stem.size());
    const std::string_view part = std::string_view(stem).substr(begin, end - begin);
    begin = end + 1;
    if (const auto type = stored_type_named(part))
      shape.type = type;
    else if (const auto size = triple<std::uint64_t>(part))
      shape.size = size;
    else if (part.ends_with("mm"))
      if (const auto mm = triple<double>(part.substr(0, part.size() - 2)))
        shape.spacing_mm = glm::dvec3((*mm)[0], (*mm)[1], (*mm)[2]);
  }
  return shape;
}

std::optional<Failure> read_exactly(const fs::path& file, std::span<std::byte> to,
                                    const std::function<void(double)>& progress) {
  std::ifstream stream(file, std::ios::binary);
  for (std::size_t done = 0; done < to.size();) {
    const std::size_t part = std::min(kChunk, to.size() - done);
    if (!stream.read(reinterpret_cast<char*>(to.data() + done), std::streamsize(part)))
      return failure_of(file, fmt::format("reading stopped after {} bytes", done),
                        "check the file and the disk");
    done += part;
    if (progress) progress(double(done) / double(to.size()));
  }
  return std::nullopt;
}

// All of info but its statistics, and the bytes that the file must have.
Result<std::uint64_t> describe(const fs::path& file, const LoadOptions& options, VolumeInfo& info,
                               StoredType& type) {
  const RawShape shape = shape_of(file.stem().string());
  if (!shape.size || !shape.type)
    return failure_of(
        file, "its name does not tell the shape of its voxels",
        "name it like head_256x256x108_int16.raw or head_256x256x108_1x1x1.5mm_int16.raw");
  info.file = file.string();
  info.format = "raw";
  info.geometry.spacing_mm = shape.spacing_mm.value_or(glm::dvec3(1));
  type = *shape.type;
  if (auto failure = check_geometry(file, *shape.size, info.geometry)) return *failure;
  info.geometry.origin_mm =
      -0.5 * info.geometry.spacing_mm * glm::dvec3(info.geometry.size - 1) + 0.0;
  set_types(type, info);
  if (auto failure = choose_component(options, info)) return *failure;
  return info.geometry.voxel_count() * bytes_of(type);
}

}  // namespace

Result<LoadedVolume> load_raw_volume(const fs::path& file, const LoadOptions& options,
                                     bool header_only) {
  LoadedVolume loaded;
  StoredType type{};
  const auto bytes = describe(file, options, loaded.info, type);
  if (!bytes) return bytes.failure();
  std::error_code error;
  const std::uint64_t file_bytes = fs::file_size(file, error);
  if (error || file_bytes != *bytes)
    return failure_of(
        file,
        fmt::format("its name promises {} bytes, and it has {}", *bytes, error ? 0 : file_bytes),
        "correct the size or the type in its name");
  if (header_only) return loaded;
  auto memory = allocate_voxels(file, *bytes);
  if (!memory) return memory.failure();
  loaded.memory = std::move(*memory);
  if (auto failure = read_exactly(file, {loaded.memory.get(), *bytes}, options.progress))
    return *failure;
  loaded.byte_count = loaded.info.geometry.voxel_count() * bytes_per_voxel(loaded.info.type);
  take_component({loaded.memory.get(), *bytes}, type, 1, 0,
                 {loaded.memory.get(), loaded.byte_count});
  return loaded;
}

}  // namespace goldthread
