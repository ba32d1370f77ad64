// SPDX-License-Identifier: Apache-2.0
#pragma once
// The NIfTI-1 header, read before ITK does: its library writes to stderr about what it refuses, and
// cannot tell where voxels begin that may be taken as they are. Internal to volume_io.

#include <cstdint>
#include <filesystem>
#include <optional>

#include "common/base/result.h"
#include "common/volume/stored_type.h"

namespace goldthread {

/// Whether the header of `file` (of its .hdr, for an .img) is one of NIfTI-1 or Analyze, in either
/// byte order, with sizes above 0 and a type that the standard knows.
std::optional<Failure> check_nifti_header(const std::filesystem::path& file);

/// For a NIfTI-1 file with header and voxels in one, in this machine's byte order, of one component
/// of `type`, and not to be rescaled: the number of bytes, once inflated, before its voxels.
std::optional<std::uint64_t> nifti_voxels_offset(const std::filesystem::path& file, StoredType type,
                                                 std::uint64_t components);

}  // namespace goldthread
