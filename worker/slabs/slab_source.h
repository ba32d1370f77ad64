// SPDX-License-Identifier: Apache-2.0
#pragma once
// The samples of a volume that lies in slabs, as one source: rays are sent from slab to slab in the
// order of depth, each with what it has gathered, and those that can see no further stay behind.
// What comes back is to the bit what one worker would have cast that held the whole volume: so all
// that is built on samples (subdivision, refinement, the error they estimate) works with slabs as
// it does without.
//
// To merge segments that all slabs cast at once would need fewer hops, but gives another picture: a
// ray that ends early lets its colour stand for the rest, and a slab behind cannot know that it was
// not needed (docs/slabs.md).

#include <memory>
#include <vector>

#include "common/tile/sample.h"
#include "worker/sample_source.h"
#include "worker/slabs/slab_caster.h"
#include "worker/slabs/slab_paths.h"

namespace goldthread {

/// Rays that are sent to another worker and come back.
struct RayBatch {
  Stage stage;
  std::vector<PixelPosition> positions;
  std::vector<Sample> samples;
  std::vector<std::uint32_t> surfaces;  ///< as many, or none
  std::uint64_t taken = 0;              ///< field evaluations, once cast

  RaySpan span() { return {positions, samples, surfaces}; }
};

/// Takes rays through one slab, wherever it lies.
class SlabLink {
 public:
  virtual ~SlabLink() = default;
  /// Returns when it is done; false if the view is no longer wanted.
  virtual bool advance(int slab, RayBatch& batch) const = 0;
};

/// `link` casts through any slab; the scene is as of any of them.
std::shared_ptr<const SampleSource> make_slab_source(std::shared_ptr<const SlabLink> link,
                                                     std::shared_ptr<const SlabCaster> own,
                                                     SlabPaths paths);

}  // namespace goldthread
