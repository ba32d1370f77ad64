// SPDX-License-Identifier: Apache-2.0
#include "slab_support.h"

#include <cmath>
#include <cstring>
#include <utility>

#include "common/volume/build_volume.h"

namespace goldthread::test {
namespace {

template <class T>
void put(double value, std::byte* to) {
  const T number = T(value);
  std::memcpy(to, &number, sizeof(T));
}

void put(VoxelType type, double value, std::byte* to) {
  switch (type) {
    case VoxelType::kUInt8:
      return put<std::uint8_t>(value, to);
    case VoxelType::kInt8:
      return put<std::int8_t>(value, to);
    case VoxelType::kUInt16:
      return put<std::uint16_t>(value, to);
    case VoxelType::kInt16:
      return put<std::int16_t>(value, to);
    case VoxelType::kFloat32:
      return put<float>(value, to);
  }
}

}  // namespace

std::vector<std::shared_ptr<const Volume>> cut(const Volume& volume, int slabs) {
  const VolumeInfo& whole = volume.info();
  const glm::ivec3 size = whole.geometry.size;
  const std::size_t width = bytes_per_voxel(whole.type);
  const SliceReader read = [&](int first, int count,
                               std::span<std::byte> to) -> std::optional<Failure> {
    std::byte* at = to.data();
    for (int z = first; z < first + count; ++z)
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x, at += width) put(whole.type, volume.at(x, y, z), at);
    return std::nullopt;
  };
  std::vector<std::shared_ptr<const Volume>> parts;
  for (int i = 0; i < slabs; ++i) {
    const Slab slab = slab_of(size.z, i, slabs);
    const std::size_t bytes = Volume::block_bytes(whole.geometry, whole.type, slab);
    const std::shared_ptr<std::byte> block(
        new (std::align_val_t(kBlockAlignment)) std::byte[bytes],
        [](std::byte* memory) { ::operator delete[](memory, std::align_val_t(kBlockAlignment)); });
    VolumeInfo info = whole;
    fill_slab(info, slab, read, {block.get(), bytes});
    parts.push_back(std::make_shared<const Volume>(whole, slab, block));
  }
  return parts;
}

bool SlabsAtHand::advance(int slab, RayBatch& batch) const {
  batch.taken = casters_[std::size_t(slab)]->advance(batch.span(), batch.stage).samples;
  sent_[std::size_t(slab)] += batch.positions.size();
  return true;
}

std::shared_ptr<const SlabsAtHand> slabs_at_hand(
    const Scene& scene, const std::vector<std::shared_ptr<const Volume>>& slabs) {
  std::vector<std::shared_ptr<const SlabCaster>> casters;
  for (const auto& slab : slabs)
    casters.push_back(make_slab_caster(commit_scene(scene, slab), *scene.camera, scene.image.size));
  return std::make_shared<const SlabsAtHand>(std::move(casters));
}

std::shared_ptr<const SampleSource> slab_source_of(
    const Scene& scene, const std::vector<std::shared_ptr<const Volume>>& slabs) {
  const auto own =
      make_slab_caster(commit_scene(scene, slabs.front()), *scene.camera, scene.image.size);
  return make_slab_source(slabs_at_hand(scene, slabs), own,
                          SlabPaths(*scene.camera, scene.image.size, slabs.front()->info().geometry,
                                    int(slabs.size())));
}

}  // namespace goldthread::test
