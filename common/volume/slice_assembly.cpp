// SPDX-License-Identifier: Apache-2.0
#include "common/volume/slice_assembly.h"

#include <fmt/format.h>

#include <vector>

#include "common/volume/volume_checks.h"

namespace goldthread {

std::size_t SliceAssembly::slice_voxels() const {
  const glm::ivec3 size = loaded_.info.geometry.size;
  return std::size_t(size.x) * std::size_t(size.y);
}

std::optional<Failure> SliceAssembly::begin(StoredType type) {
  type_ = type;
  set_types(type, loaded_.info);
  loaded_.byte_count = loaded_.info.geometry.voxel_count() * bytes_per_voxel(loaded_.info.type);
  auto memory = allocate_voxels(loaded_.info.file, loaded_.byte_count);
  if (!memory) return memory.failure();
  loaded_.memory = std::move(*memory);
  return std::nullopt;
}

std::optional<Failure> SliceAssembly::become_float() {
  const std::size_t count = loaded_.info.geometry.voxel_count();
  auto memory = allocate_voxels(loaded_.info.file, count * sizeof(float));
  if (!memory) return memory.failure();
  const std::size_t done = slice_voxels() * std::size_t(slices_);
  widen_to_float({loaded_.memory.get(), done * bytes_per_voxel(loaded_.info.type)},
                 loaded_.info.type, {reinterpret_cast<float*>(memory->get()), done});
  loaded_.memory = std::move(*memory);
  loaded_.byte_count = count * sizeof(float);
  loaded_.info.type = VoxelType::kFloat32;
  loaded_.info.notes.push_back("its slices are of several types: held as float32");
  return std::nullopt;
}

std::optional<Failure> SliceAssembly::add(std::span<const std::byte> pixels, StoredType type) {
  if (slices_ == 0) {
    if (auto failure = begin(type)) return failure;
  } else if (held_type(type) != loaded_.info.type && loaded_.info.type != VoxelType::kFloat32) {
    if (auto failure = become_float()) return failure;
  }
  const VolumeInfo& info = loaded_.info;
  const std::size_t voxels = slice_voxels();
  const std::size_t bytes = voxels * bytes_per_voxel(info.type);
  std::byte* to = loaded_.memory.get() + std::size_t(slices_++) * bytes;
  if (held_type(type) == info.type) {
    take_component(pixels, type, info.components, info.component, {to, bytes});
    return std::nullopt;
  }
  std::vector<std::byte> held(voxels * bytes_per_voxel(held_type(type)));
  take_component(pixels, type, info.components, info.component, held);
  widen_to_float(held, held_type(type), {reinterpret_cast<float*>(to), voxels});
  return std::nullopt;
}

}  // namespace goldthread
