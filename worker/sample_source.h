// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where samples come from: the ray caster, or the stub that by-passes it. A source is one view
// (scene, volume, camera and image size), immutable, and may be asked from any number of threads.

#include <cstddef>
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

/// Rays between two looks at whether the work is still wanted: some tens of packets, about a
/// millisecond.
constexpr std::size_t kBatchRays = 512;

class SampleSource {
 public:
  virtual ~SampleSource() = default;
  /// One ray through each position; samples[i] belongs to positions[i] and depends on it alone:
  /// not on its neighbours in the span, their order, or the calling thread. `surfaces` is empty, or
  /// as long as positions: then surfaces[i] tells sequences of isosurfaces apart that rays met
  /// before they ended. Rays that met the same ones in the same order have the same number, 0 if
  /// there were none; others may share one by chance, if they met very many.
  virtual CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                          std::span<std::uint32_t> surfaces) const = 0;
  CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples) const {
    return cast(positions, samples, {});
  }
  /// Rays that are best cast at a time: so few that work which is no longer wanted ends soon.
  virtual std::size_t batch_rays() const { return kBatchRays; }
  /// Whether a ray can meet an isosurface; if not, all `surfaces` are 0.
  virtual bool has_surfaces() const { return false; }
};

}  // namespace goldthread
