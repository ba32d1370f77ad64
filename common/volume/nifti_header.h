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

/// What the header of a NIfTI-1 or Analyze file says of its voxels.
struct NiftiVoxels {
  std::optional<StoredType> type;  ///< one real number per voxel; absent: RGB, complex, …
  std::uint64_t voxel_bytes = 0;   ///< of one number, or of all of an RGB or complex one
  std::uint64_t offset = 0;        ///< before the voxels, once inflated; 0 for a file beside
  bool native = false;             ///< this machine's byte order
  double slope = 1, intercept = 0;

  bool rescaled() const { return slope != 1 || intercept != 0; }
  /// Whether the file, inflated, holds the voxels as they lie in memory behind `offset`.
  bool direct() const { return type && native && offset > 0; }
  /// The type of voxel · slope + intercept: int16 where it surely fits, or else float32.
  StoredType value_type() const;
};

/// Reads the header of `file` (of its .hdr, for an .img), in either byte order. A Failure unless
/// its sizes are above 0 and its type is one that the standard knows.
Result<NiftiVoxels> read_nifti_header(const std::filesystem::path& file);

}  // namespace goldthread
