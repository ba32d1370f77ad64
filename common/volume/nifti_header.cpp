// SPDX-License-Identifier: Apache-2.0
#include "common/volume/nifti_header.h"

#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <bit>
#include <cmath>
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

// Fields in either byte order.
class Fields {
 public:
  Fields(const Header& header, bool swapped) : header_(header), swapped_(swapped) {}
  int number(std::size_t offset) const {
    const auto value = field<std::uint16_t>(header_, offset);
    return std::int16_t(swapped_ ? std::uint16_t(value << 8 | value >> 8) : value);
  }
  float real(std::size_t offset) const {
    auto value = field<std::uint32_t>(header_, offset);
    if (swapped_) value = __builtin_bswap32(value);
    return std::bit_cast<float>(value);
  }

 private:
  const Header& header_;
  bool swapped_;
};

// Bytes of a voxel for each code of the standard; 0 for what it does not know.
std::uint64_t voxel_bytes_of(int code) {
  switch (code) {
    case 2:
    case 256:
      return 1;
    case 4:
    case 512:
      return 2;
    case 128:
      return 3;
    case 8:
    case 16:
    case 768:
    case 2304:
      return 4;
    case 32:
    case 64:
    case 1024:
    case 1280:
      return 8;
    case 1536:
    case 1792:
      return 16;
    case 2048:
      return 32;
    default:
      return 0;
  }
}

std::optional<StoredType> type_of(int datatype) {
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

// A slope of 0 means that there is none; one that is not finite cannot be meant.
void read_scale(const Fields& fields, NiftiVoxels& voxels) {
  const float slope = fields.real(kSlope), intercept = fields.real(kIntercept);
  if (slope == 0 || !std::isfinite(slope) || !std::isfinite(intercept)) return;
  voxels.slope = double(slope);
  voxels.intercept = double(intercept);
}

}  // namespace

StoredType NiftiVoxels::value_type() const {
  if (!rescaled()) return *type;
  double least = 0, greatest = 0;
  switch (*type) {
    case StoredType::kUInt8:
      greatest = 255;
      break;
    case StoredType::kInt8:
      least = -128, greatest = 127;
      break;
    case StoredType::kUInt16:
      greatest = 65535;
      break;
    case StoredType::kInt16:
      least = -32768, greatest = 32767;
      break;
    default:
      return StoredType::kFloat32;
  }
  const auto fits = [&](double voxel) {
    const double value = voxel * slope + intercept;
    return value >= -32768 && value <= 32767;
  };
  const bool whole = slope == std::floor(slope) && intercept == std::floor(intercept);
  return whole && fits(least) && fits(greatest) ? StoredType::kInt16 : StoredType::kFloat32;
}

Result<NiftiVoxels> read_nifti_header(const std::filesystem::path& file) {
  const char* const mend = "the file is damaged, or its name ends wrongly";
  const bool beside = has_ending(file, ".img");
  const auto header =
      read_header(beside ? std::filesystem::path(file).replace_extension(".hdr") : file);
  if (!header) return failure_of(file, "it holds no whole NIfTI header", mend);
  if (field<std::int32_t>(*header, kSizeOfHeader) == 540)
    return failure_of(file, "it is NIfTI-2, which is not read", "write it as NIfTI-1");
  const auto is_count = [](int axes) { return axes >= 1 && axes <= 7; };
  NiftiVoxels voxels;
  voxels.native = is_count(Fields(*header, false).number(kDimensions));
  const Fields fields(*header, !voxels.native);
  const int axes = fields.number(kDimensions);
  if (!is_count(axes)) return failure_of(file, "it is no NIfTI file", mend);
  for (std::size_t axis = 1; axis <= std::size_t(axes); ++axis)
    if (const int size = fields.number(kDimensions + 2 * axis); size < 1)
      return failure_of(file, fmt::format("its size along axis {} is {}", axis, size), mend);
  voxels.voxel_bytes = voxel_bytes_of(fields.number(kDatatype));
  if (voxels.voxel_bytes == 0)
    return failure_of(file, fmt::format("NIfTI has no voxel type {}", fields.number(kDatatype)),
                      mend);
  voxels.type = type_of(fields.number(kDatatype));
  read_scale(fields, voxels);
  if (std::memcmp(header->data() + kMagic, "n+1", 4) != 0) return voxels;
  const float offset = fields.real(kVoxelOffset);
  if (!(offset >= 352 && offset <= float(1 << 24)))
    return failure_of(file, fmt::format("its voxels begin at byte {}", offset), mend);
  voxels.offset = std::uint64_t(offset);
  return voxels;
}

}  // namespace goldthread
