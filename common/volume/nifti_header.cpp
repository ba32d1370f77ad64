// SPDX-License-Identifier: Apache-2.0
#include "common/volume/nifti_header.h"

#include <zlib.h>

#include <array>
#include <cstring>
#include <memory>

namespace goldthread {
namespace {

constexpr std::size_t kHeaderBytes = 348;
using Header = std::array<char, kHeaderBytes>;

// Offsets of the NIfTI-1 standard.
constexpr std::size_t kSizeOfHeader = 0, kDatatype = 70, kVoxelOffset = 108, kSlope = 112,
                      kIntercept = 116, kMagic = 344;

template <class T>
T field(const Header& header, std::size_t offset) {
  T value;
  std::memcpy(&value, header.data() + offset, sizeof value);
  return value;
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

std::optional<std::uint64_t> nifti_voxels_offset(const std::filesystem::path& file, StoredType type,
                                                 std::uint64_t components) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> stream(gzopen(file.c_str(), "rb"), gzclose);
  Header header;
  if (components != 1 || !stream ||
      gzread(stream.get(), header.data(), kHeaderBytes) != int(kHeaderBytes) ||
      field<std::int32_t>(header, kSizeOfHeader) != std::int32_t(kHeaderBytes) ||
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
