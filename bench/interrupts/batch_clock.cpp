// SPDX-License-Identifier: Apache-2.0
#include "bench/interrupts/batch_clock.h"

#include <algorithm>

#include "bench/error/rounds.h"
#include "worker/refine_tile.h"

namespace goldthread::bench {

CastCounts BatchClock::cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                            std::span<std::uint32_t> surfaces) const {
  CastCounts counts;
  for (std::size_t first = 0; first < positions.size(); first += kBatchRays) {
    const std::size_t count = std::min(kBatchRays, positions.size() - first);
    const double seconds = seconds_of([&] {
      counts += source_.cast(positions.subspan(first, count), samples.subspan(first, count),
                             surfaces.subspan(first, count));
    });
    if (count < kBatchRays) continue;
    const std::lock_guard lock(mutex_);
    seconds_.push_back(seconds);
  }
  return counts;
}

}  // namespace goldthread::bench
