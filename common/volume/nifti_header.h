// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where the voxels of a NIfTI file begin, if they may be taken from it as they are; internal to
// volume_io.

#include <cstdint>
#include <filesystem>
#include <optional>

#include "common/volume/stored_type.h"

namespace goldthread {

/// For a NIfTI-1 file with header and voxels in one, in this machine's byte order, of one component
/// of `type`, and not to be rescaled: the number of bytes, once inflated, before its voxels.
std::optional<std::uint64_t> nifti_voxels_offset(const std::filesystem::path& file, StoredType type,
                                                 std::uint64_t components);

}  // namespace goldthread
