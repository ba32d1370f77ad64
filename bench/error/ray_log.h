// SPDX-License-Identifier: Apache-2.0
#pragma once
// The rays of a picture in the batches in which they were cast, to be cast again without anything
// around them: what is left of the picture's time is what choosing rays costs.

#include <mutex>
#include <vector>

#include "bench/error/crew.h"
#include "worker/sample_source.h"

namespace goldthread::bench {

/// Casts as its source does, and remembers each batch.
class RayLog final : public SampleSource {
 public:
  explicit RayLog(const SampleSource& source) : source_(source) {}

  using SampleSource::cast;
  CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                  std::span<std::uint32_t> surfaces) const override;
  bool has_surfaces() const override { return source_.has_surfaces(); }

  /// Casts all batches again. The seconds of processors that this takes.
  double replay(Crew& crew) const;

 private:
  const SampleSource& source_;
  mutable std::mutex mutex_;
  mutable std::vector<std::vector<PixelPosition>> batches_;
};

}  // namespace goldthread::bench
