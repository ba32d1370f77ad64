// SPDX-License-Identifier: Apache-2.0
#pragma once
// Bare voxels whose file name tells their shape; internal to volume_io.

#include <filesystem>

#include "common/base/result.h"
#include "common/volume/volume_io.h"

namespace goldthread {

/// `name_256x256x108_int16.raw`, or with the distance of voxels
/// `name_256x256x108_1x1x1.5mm_int16.raw` (1 mm if absent): x fastest, little endian, nothing
/// before or after the voxels. Centred on the origin, as there is nothing that says otherwise.
Result<LoadedVolume> load_raw_volume(const std::filesystem::path& file, const LoadOptions& options,
                                     bool header_only);

}  // namespace goldthread
