// SPDX-License-Identifier: Apache-2.0
#pragma once
// From voxels in a file's order to a Volume: columns of voxels, cell ranges and
// statistics, in one parallel pass (floats: one more for the histogram).

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/base/result.h"

#include "common/volume/volume.h"

namespace goldthread {

/// Fills `block` (block_bytes(geometry, type) bytes, aligned to 64, which may be memory shared with
/// other processes) from `linear_voxels`: voxels in info.type, x fastest, then y, then z; and fills
/// in info's minimum, maximum, not_finite and histogram. Threads: those of the caller's TBB arena.
void fill_block(VolumeInfo& info, std::span<const std::byte> linear_voxels,
                std::span<std::byte> block);

/// Puts slices [first, first + count) of a volume, voxels in info.type, x fastest, into `to`.
using SliceReader =
    std::function<std::optional<Failure>(int first, int count, std::span<std::byte> to)>;

/// The same of a slab, from slices that are read a few at a time, in ascending order, some of them
/// twice. Statistics are those of the slab's own
/// voxels (SlabStatistics); the histogram of all slabs is count_voxels()'s work. Ten slices at
/// least are in memory at a time.
std::optional<Failure> fill_slab(VolumeInfo& info, const Slab& slab, const SliceReader& read,
                                 std::span<std::byte> block,
                                 const std::function<void(double)>& progress = nullptr);

/// The own voxels of a volume or slab that are finite, in 256 equal bins over [minimum, maximum].
std::vector<std::uint64_t> count_voxels(const Volume& volume, double minimum, double maximum);

/// A whole volume, into memory of its own. Throws FatalError where there is not enough.
std::shared_ptr<const Volume> build_volume(VolumeInfo info,
                                           std::span<const std::byte> linear_voxels);

}  // namespace goldthread
