// SPDX-License-Identifier: Apache-2.0
#pragma once
// A source whose rays cost what a cost image says and compute nothing: they sleep. Any number of
// workers on few cores then work as if each had a core of its own.

#include <chrono>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "bench/scale/cost_record.h"
#include "worker/sample_source.h"

namespace goldthread::bench {

class PacedSource final : public SampleSource {
 public:
  /// A picture of `size` whose pixels in all take `us`, shared out as by the image's last step.
  PacedSource(const CostRecord& image, ImageSize size, double us);

  /// Takes as long as its rays cost; what a sleep was too long is taken off the thread's next. The
  /// field evaluations that it counts are ns.
  CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                  std::span<std::uint32_t> surfaces) const override;
  /// Counts only.
  CastCounts count(std::span<const PixelPosition> positions) const;

 private:
  void sleep(std::chrono::nanoseconds length) const;

  ImageSize size_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<double> ray_ns_;  ///< by block
  mutable std::mutex mutex_;
  mutable std::map<std::thread::id, std::chrono::nanoseconds> late_;
};

/// What a PacedSource counts, in no time.
class UnpacedSource final : public SampleSource {
 public:
  explicit UnpacedSource(const PacedSource& paced) : paced_(paced) {}
  CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                  std::span<std::uint32_t> surfaces) const override;

 private:
  const PacedSource& paced_;
};

}  // namespace goldthread::bench
