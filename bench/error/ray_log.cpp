// SPDX-License-Identifier: Apache-2.0
#include "bench/error/ray_log.h"

#include <algorithm>

namespace goldthread::bench {

CastCounts RayLog::cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                        std::span<std::uint32_t> surfaces) const {
  {
    const std::lock_guard lock(mutex_);
    batches_.emplace_back(positions.begin(), positions.end());
  }
  return source_.cast(positions, samples, surfaces);
}

double RayLog::replay(Crew& crew) const {
  const double before = crew.cpu_seconds();
  crew.share(batches_.size(), [&](std::size_t i) {
    thread_local std::vector<Sample> samples;
    thread_local std::vector<std::uint32_t> surfaces;
    const std::vector<PixelPosition>& batch = batches_[i];
    samples.resize(std::max(samples.size(), batch.size()));
    surfaces.resize(samples.size());
    source_.cast(batch, std::span(samples).first(batch.size()),
                 std::span(surfaces).first(batch.size()));
  });
  return crew.cpu_seconds() - before;
}

}  // namespace goldthread::bench
