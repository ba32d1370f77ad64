// SPDX-License-Identifier: Apache-2.0
#pragma once
// From what is known of each slab to what is known of the whole volume. Pure.

#include <cstdint>
#include <span>
#include <vector>

#include "common/volume/volume.h"

namespace goldthread {

/// Of a slab's own voxels; extremes may be those of the slice behind them.
struct SlabStatistics {
  std::uint64_t voxels = 0;
  std::uint64_t not_finite = 0;
  double minimum = 0;  ///< of the finite ones; 0 if there is none
  double maximum = 0;
};

SlabStatistics statistics_of(const VolumeInfo& info, const Slab& slab);

/// Sets the statistics of `whole` but for its histogram, which is left empty.
void merge_statistics(std::span<const SlabStatistics> parts, VolumeInfo& whole);

/// Adds a slab's histogram over the whole volume's values.
void add_counts(std::span<const std::uint64_t> counts, std::vector<std::uint64_t>& histogram);

}  // namespace goldthread
