// SPDX-License-Identifier: Apache-2.0
#pragma once
// How long a worker casts between two looks at whether its work is still wanted.

#include <mutex>
#include <vector>

#include "worker/sample_source.h"

namespace goldthread::bench {

/// Casts as its source does, in the batches of a worker, and times those that are full.
class BatchClock final : public SampleSource {
 public:
  explicit BatchClock(const SampleSource& source) : source_(source) {}

  CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                  std::span<std::uint32_t> surfaces) const override;
  bool has_surfaces() const override { return source_.has_surfaces(); }

  const std::vector<double>& seconds() const { return seconds_; }

 private:
  const SampleSource& source_;
  mutable std::mutex mutex_;
  mutable std::vector<double> seconds_;
};

}  // namespace goldthread::bench
