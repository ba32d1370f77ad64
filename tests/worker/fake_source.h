// SPDX-License-Identifier: Apache-2.0
#pragma once
// Sources of samples whose progress a test can see and hold.

#include <atomic>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <span>
#include <stdexcept>

#include "worker/sample_source.h"

namespace goldthread {

/// Each sample is its own position; counts batches and rays.
class CountingSource : public SampleSource {
 public:
  CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                  std::span<std::uint32_t>) const override {
    ++batches;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      samples[i] = {positions[i].x, positions[i].y, 0, 1};
    }
    return {positions.size(), 10 * positions.size()};
  }
  mutable std::atomic<int> batches{0};
};

/// A disc before a slope, and a grain so fine that it decides nothing, but no two rays bring back
/// the same.
class DiscSource final : public CountingSource {
 public:
  CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                  std::span<std::uint32_t> surfaces) const override {
    const CastCounts counts = CountingSource::cast(positions, samples, surfaces);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const auto [x, y] = positions[i];
      const bool inside = std::hypot(x - 40, y - 35) < 25;
      samples[i] = {(inside ? 0.75f : 0.25f) + 1e-4f * grain(x, y), inside ? 0.1f : 1e-3f * x,
                    1e-3f * y, 1};
      if (!surfaces.empty()) surfaces[i] = inside ? 1 : 0;
    }
    return counts;
  }
  bool has_surfaces() const override { return true; }

 private:
  static float grain(float x, float y) {
    const float value = std::sin(12.9898f * x + 78.233f * y) * 437.585f;
    return value - std::floor(value);
  }
};

/// Stops in each batch until the test lets it go on.
class HeldSource final : public CountingSource {
 public:
  CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                  std::span<std::uint32_t> surfaces) const override {
    std::unique_lock lock(mutex_);
    ++entered_;
    changed_.notify_all();
    changed_.wait(lock, [&] { return allowed_ > 0; });
    --allowed_;
    return CountingSource::cast(positions, samples, surfaces);
  }
  /// Returns once `count` batches have been begun since the start.
  void wait_until_entered(int count) const {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return entered_ >= count; });
  }
  void allow(int count) const {
    const std::lock_guard lock(mutex_);
    allowed_ += count;
    changed_.notify_all();
  }

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  mutable int entered_ = 0;
  mutable int allowed_ = 0;
};

class FailingSource final : public SampleSource {
 public:
  CastCounts cast(std::span<const PixelPosition>, std::span<Sample>,
                  std::span<std::uint32_t>) const override {
    throw std::runtime_error("the ray caster fell over");
  }
};

}  // namespace goldthread
