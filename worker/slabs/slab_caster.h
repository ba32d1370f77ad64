// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a worker does with rays on their way through the volume: it takes them through its own slab.

#include <cstdint>
#include <span>

#include "common/tile/sample.h"
#include "worker/sample_source.h"
#include "worker/slabs/stage.h"

namespace goldthread {

/// Rays, and what each has gathered. `surfaces` is as long as the others where the scene has
/// isosurfaces, or else empty.
struct RaySpan {
  std::span<const PixelPosition> positions;
  std::span<Sample> samples;
  std::span<std::uint32_t> surfaces;
};

/// One view through one slab: immutable, and may be asked from any number of threads.
class SlabCaster {
 public:
  virtual ~SlabCaster() = default;
  /// Takes rays through those of their segments that belong to the slab. A ray's result is to the
  /// bit what it would have gathered there had the volume not been cut.
  virtual CastCounts advance(const RaySpan& rays, Stage stage) const = 0;
  /// Whether a ray can meet an isosurface.
  virtual bool has_surfaces() const = 0;
  /// Whether rays look for the greatest value (mip) and not for sums.
  virtual bool seeks_greatest() const = 0;
};

}  // namespace goldthread
