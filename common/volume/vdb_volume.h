// SPDX-License-Identifier: Apache-2.0
#pragma once
// OpenVDB grids as regular volumes; internal to volume_io.

#include <filesystem>

#include "common/base/result.h"
#include "common/volume/volume_io.h"

namespace goldthread {

/// The grid named options.grid, or the first one of numbers, as float32 over the bounding box of
/// its active voxels. World units are taken as millimetres. A frustum is refused: its voxels are
/// not on an affine grid.
Result<LoadedVolume> load_vdb_volume(const std::filesystem::path& file, const LoadOptions& options,
                                     bool header_only);

}  // namespace goldthread
