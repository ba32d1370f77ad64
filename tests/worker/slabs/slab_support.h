// SPDX-License-Identifier: Apache-2.0
#pragma once
// Volumes cut into slabs, and their pictures, in one process.

#include <memory>
#include <vector>

#include "common/scene/scene.h"
#include "common/volume/volume.h"
#include "worker/ray_caster.h"
#include "worker/slabs/slab_source.h"

namespace goldthread::test {

/// Copies of the parts of a whole volume, each of which holds no more than a slab does.
std::vector<std::shared_ptr<const Volume>> cut(const Volume& volume, int slabs);

/// Casts through all slabs at hand, each in its turn, and counts the rays sent.
class SlabsAtHand final : public SlabLink {
 public:
  explicit SlabsAtHand(std::vector<std::shared_ptr<const SlabCaster>> casters)
      : casters_(std::move(casters)), sent_(casters_.size()) {}
  bool advance(int slab, RayBatch& batch) const override;
  std::size_t sent(int slab) const { return sent_[std::size_t(slab)]; }

 private:
  std::vector<std::shared_ptr<const SlabCaster>> casters_;
  mutable std::vector<std::size_t> sent_;
};

std::shared_ptr<const SlabsAtHand> slabs_at_hand(
    const Scene& scene, const std::vector<std::shared_ptr<const Volume>>& slabs);

/// The source of a scene's samples through slabs.
std::shared_ptr<const SampleSource> slab_source_of(
    const Scene& scene, const std::vector<std::shared_ptr<const Volume>>& slabs);

}  // namespace goldthread::test
