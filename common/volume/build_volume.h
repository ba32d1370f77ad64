// SPDX-License-Identifier: Apache-2.0
#pragma once
// From voxels in a file's order to a Volume: columns of voxels, cell ranges and
// statistics, in one parallel pass (floats: one more for the histogram).

#include <cstddef>
#include <memory>
#include <span>

#include "common/volume/volume.h"

namespace goldthread {

/// Fills `block` (block_bytes(geometry, type) bytes, aligned to 64, which may be memory shared with
/// other processes) from `linear_voxels`: voxels in info.type, x fastest, then y, then z; and fills
/// in info's minimum, maximum, not_finite and histogram. Threads: those of the caller's TBB arena.
void fill_block(VolumeInfo& info, std::span<const std::byte> linear_voxels,
                std::span<std::byte> block);

/// The same, into memory of its own. Throws FatalError where there is not enough.
std::shared_ptr<const Volume> build_volume(VolumeInfo info,
                                           std::span<const std::byte> linear_voxels);

}  // namespace goldthread
