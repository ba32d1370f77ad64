// SPDX-License-Identifier: Apache-2.0
#pragma once
// A volume file slice by slice, for those who want a part of it. Where the voxels lie in a file as
// they are (raw, and NIfTI, NRRD and MetaImage without compression) only what is asked for is read;
// of every other file all of it, which then stays in memory until the slices are no longer wanted.

#include <filesystem>

#include "common/base/result.h"
#include "common/volume/build_volume.h"
#include "common/volume/volume_io.h"

namespace goldthread {

struct VolumeSlices {
  VolumeInfo info;           ///< without statistics
  SliceReader read;          ///< from one thread at a time
  bool reads_parts = false;  ///< no more than is asked for
};

Result<VolumeSlices> open_slices(const std::filesystem::path& path,
                                 const LoadOptions& options = {});

}  // namespace goldthread
