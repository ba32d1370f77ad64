// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where a file has its voxels, if they lie there as they are: in one run, one number for each,
// uncompressed, in this machine's byte order. Internal to volume_slices.

#include <cstdint>
#include <filesystem>
#include <optional>

#include "common/volume/stored_type.h"
#include "common/volume/volume.h"

namespace goldthread {

struct VoxelPlace {
  std::filesystem::path file;
  std::uint64_t offset = 0;
  StoredType type = StoredType::kUInt8;
};

/// Of a file whose header says `info`. Nothing where the voxels must be decoded, or where it is not
/// sure.
std::optional<VoxelPlace> find_voxels(const std::filesystem::path& file, const VolumeInfo& info);

}  // namespace goldthread
