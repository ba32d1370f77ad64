// SPDX-License-Identifier: Apache-2.0
#include "common/volume/slab_statistics.h"

#include <algorithm>
#include <limits>

namespace goldthread {

SlabStatistics statistics_of(const VolumeInfo& info, const Slab& slab) {
  const glm::ivec3 size = info.geometry.size;
  const std::uint64_t slices = std::uint64_t(own_slices(slab, size.z).count());
  return {slices * std::uint64_t(size.x) * std::uint64_t(size.y), info.not_finite, info.minimum,
          info.maximum};
}

void merge_statistics(std::span<const SlabStatistics> parts, VolumeInfo& whole) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double minimum = kInfinity, maximum = -kInfinity;
  whole.not_finite = 0;
  for (const SlabStatistics& part : parts) {
    whole.not_finite += part.not_finite;
    if (part.not_finite == part.voxels) continue;
    minimum = std::min(minimum, part.minimum);
    maximum = std::max(maximum, part.maximum);
  }
  const bool any = minimum <= maximum;
  whole.minimum = any ? minimum : 0;
  whole.maximum = any ? maximum : 0;
  whole.histogram.clear();
}

void add_counts(std::span<const std::uint64_t> counts, std::vector<std::uint64_t>& histogram) {
  histogram.resize(std::max(histogram.size(), counts.size()));
  for (std::size_t i = 0; i < counts.size(); ++i) histogram[i] += counts[i];
}

}  // namespace goldthread
