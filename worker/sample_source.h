// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where samples come from: the ray caster, or the stub that by-passes it. A source is one view
// (scene, volume, camera and image size), immutable, and may be asked from any number of threads.

#include <cstdint>
#include <span>

#include "common/tile/sample.h"

namespace goldthread {

/// What casting cost, in things that can be counted.
struct CastCounts {
  std::uint64_t rays = 0;
  std::uint64_t samples = 0;  ///< field evaluations along rays
  CastCounts& operator+=(const CastCounts& other) {
    rays += other.rays;
    samples += other.samples;
    return *this;
  }
};

class SampleSource {
 public:
  virtual ~SampleSource() = default;
  /// One ray through each position; samples[i] belongs to positions[i] and depends on it alone:
  /// not on its neighbours in the span, their order, or the calling thread.
  virtual CastCounts cast(std::span<const PixelPosition> positions,
                          std::span<Sample> samples) const = 0;
};

}  // namespace goldthread
