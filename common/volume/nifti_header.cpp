// SPDX-License-Identifier: Apache-2.0
#include "common/volume/nifti_header.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

#include "common/volume/file_names.h"
#include "common/volume/volume_checks.h"

namespace goldthread {
namespace {

constexpr std::size_t kHeaderBytes = 348;
using Header = std::array<char, kHeaderBytes>;

// Offsets of the NIfTI-1 standard.
constexpr std::size_t kSizeOfHeader = 0, kDimensions = 40, kDatatype = 70, kVoxelOffset = 108,
                      kSlope = 112, kIntercept = 116, kMagic = 344;

template <class T>
T field(const Header& header, std::size_t offset) {
  T value;
  std::memcpy(&value, header.data() + offset, sizeof value);
  return value;
}

std::optional<Header> read_header(const std::filesystem::path& file) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> stream(gzopen(file.c_str(), "rb"), gzclose);
  Header header;
  if (!stream || gzread(stream.get(), header.data(), kHeaderBytes) != int(kHeaderBytes))
    return std::nullopt;
  return header;
}

// A 16-bit field, in the other byte order if `swapped`.
int short_field(const Header& header, std::size_t offset, bool swapped) {
  const auto value = field<std::uint16_t>(header, offset);
  return std::int16_t(swapped ? std::uint16_t(value << 8 | value >> 8) : value);
}

bool is_datatype(int code) {
  constexpr std::array<int, 16> kCodes{2,   4,   8,    16,   32,   64,   128,  256,
                                       512, 768, 1024, 1280, 1536, 1792, 2048, 2304};
  return std::find(kCodes.begin(), kCodes.end(), code) != kCodes.end();
}

std::optional<StoredType> type_of(std::int16_t datatype) {
  switch (datatype) {
    case 2:
      return StoredType::kUInt8;
    case 4:
      return StoredType::kInt16;
    case 8:
      return StoredType::kInt32;
    case 16:
      return StoredType::kFloat32;
    case 64:
      return StoredType::kFloat64;
    case 256:
      return StoredType::kInt8;
    case 512:
      return StoredType::kUInt16;
    case 768:
      return StoredType::kUInt32;
    case 1024:
      return StoredType::kInt64;
    case 1280:
      return StoredType::kUInt64;
    default:
      return std::nullopt;
  }
}

}  // namespace

std::optional<Failure> check_nifti_header(const std::filesystem::path& file) {
  const char* kMend = "the file is damaged, or its name ends wrongly";
  const bool detached = has_ending(file, ".img");
  const auto header =
      read_header(detached ? std::filesystem::path(file).replace_extension(".hdr") : file);
  if (!header) return failure_of(file, "it holds no whole NIfTI header", kMend);
  if (field<std::int32_t>(*header, kSizeOfHeader) == 540)
    return failure_of(file, "it is NIfTI-2, which is not read", "write it as NIfTI-1");
  const auto is_count = [](int axes) { return axes >= 1 && axes <= 7; };
  const bool swapped = !is_count(short_field(*header, kDimensions, false));
  const int axes = short_field(*header, kDimensions, swapped);
  if (!is_count(axes)) return failure_of(file, "it is no NIfTI file", kMend);
  for (std::size_t axis = 1; axis <= std::size_t(axes); ++axis)
    if (const int size = short_field(*header, kDimensions + 2 * axis, swapped); size < 1)
      return failure_of(file, fmt::format("its size along axis {} is {}", axis, size), kMend);
  if (const int code = short_field(*header, kDatatype, swapped); !is_datatype(code))
    return failure_of(file, fmt::format("NIfTI has no voxel type {}", code), kMend);
  return std::nullopt;
}

std::optional<std::uint64_t> nifti_voxels_offset(const std::filesystem::path& file, StoredType type,
                                                 std::uint64_t components) {
  const auto read = read_header(file);
  if (!read || components != 1) return std::nullopt;
  const Header& header = *read;
  if (field<std::int32_t>(header, kSizeOfHeader) != std::int32_t(kHeaderBytes) ||
      std::memcmp(header.data() + kMagic, "n+1", 4) != 0 ||
      type_of(field<std::int16_t>(header, kDatatype)) != type)
    return std::nullopt;
  const float slope = field<float>(header, kSlope), intercept = field<float>(header, kIntercept);
  if (slope != 0 && !(slope == 1 && intercept == 0)) return std::nullopt;
  const float offset = field<float>(header, kVoxelOffset);
  if (!(offset >= 352 && offset <= 1 << 24)) return std::nullopt;
  const auto bytes = std::uint64_t(offset);
  return bytes % bytes_of(type) == 0 ? std::optional(bytes) : std::nullopt;
}

}  // namespace goldthread
