// SPDX-License-Identifier: Apache-2.0
#include "common/volume/volume.h"

#include <array>
#include <bit>
#include <glm/gtc/matrix_inverse.hpp>

namespace goldthread {
namespace {

// A voxel's bytes, one from each plane, as a number of type T.
template <class T>
double element(const std::byte* first, std::int64_t plane_bytes) {
  std::array<std::byte, sizeof(T)> bytes;
  for (std::size_t plane = 0; plane < sizeof(T); ++plane)
    bytes[plane] = first[std::int64_t(plane) * plane_bytes];
  return double(std::bit_cast<T>(bytes));
}

std::size_t aligned(std::size_t bytes) {
  return (bytes + kBlockAlignment - 1) / kBlockAlignment * kBlockAlignment;
}

}  // namespace

glm::dmat4 VolumeGeometry::world_from_index() const {
  glm::dmat4 map(1.0);
  for (int axis = 0; axis < 3; ++axis)
    map[axis] = glm::dvec4(direction[axis] * spacing_mm[axis], 0.0);
  map[3] = glm::dvec4(origin_mm, 1.0);
  return map;
}

glm::dmat4 VolumeGeometry::index_from_world() const {
  // Not the inverse of the 4×4 matrix: a far origin would cost digits of the linear part.
  const glm::dmat3 linear = glm::inverse(glm::dmat3(world_from_index()));
  glm::dmat4 map(linear);
  map[3] = glm::dvec4(-(linear * origin_mm), 1.0);
  return map;
}

Volume::Volume(VolumeInfo info, std::shared_ptr<const std::byte> memory)
    : info_(std::move(info)),
      slab_(whole_slab(info_.geometry.size.z)),
      layout_(info_.geometry.size, int(bytes_per_voxel(info_.type)), slab_),
      memory_(std::move(memory)) {}

Volume::Volume(VolumeInfo info, const Slab& slab, std::shared_ptr<const std::byte> memory)
    : info_(std::move(info)),
      slab_(slab),
      layout_(info_.geometry.size, int(bytes_per_voxel(info_.type)), slab_),
      memory_(std::move(memory)) {}

std::size_t Volume::cells_offset(const VolumeGeometry& geometry, VoxelType type, const Slab& slab) {
  const ColumnLayout layout(geometry.size, int(bytes_per_voxel(type)), slab);
  return aligned(std::size_t(layout.byte_count()));
}

std::size_t Volume::block_bytes(const VolumeGeometry& geometry, VoxelType type) {
  return block_bytes(geometry, type, whole_slab(geometry.size.z));
}

std::size_t Volume::block_bytes(const VolumeGeometry& geometry, VoxelType type, const Slab& slab) {
  const glm::ivec3 cells = cell_counts(geometry);
  const int layers = known_layers(slab, geometry.size.z).count();
  return aligned(cells_offset(geometry, type, slab) + std::size_t(cells.x) * std::size_t(cells.y) *
                                                          std::size_t(layers) * sizeof(CellRange));
}

glm::ivec3 Volume::cell_counts(const VolumeGeometry& geometry) {
  return (geometry.size + (kCellEdge - 1)) / kCellEdge;
}

std::span<const CellRange> Volume::cells() const {
  const glm::ivec3 counts = cell_counts();
  const std::byte* first = memory_.get() + cells_offset(info_.geometry, info_.type, slab_);
  return {reinterpret_cast<const CellRange*>(first),
          std::size_t(counts.x) * std::size_t(counts.y) * std::size_t(layers().count())};
}

double Volume::value_bias() const {
  switch (info_.type) {
    case VoxelType::kInt8:
      return -128;
    case VoxelType::kInt16:
      return -32768;
    case VoxelType::kUInt8:
    case VoxelType::kUInt16:
    case VoxelType::kFloat32:
      return 0;
  }
  return 0;
}

double Volume::at(int i, int j, int k) const {
  constexpr int kApron = ColumnLayout::kApron;
  const std::byte* first = voxels() + layout_.offset(i + kApron, j + kApron, k + kApron);
  switch (info_.type) {
    case VoxelType::kUInt8:
    case VoxelType::kInt8:
      return element<std::uint8_t>(first, layout_.plane_bytes) + value_bias();
    case VoxelType::kUInt16:
    case VoxelType::kInt16:
      return element<std::uint16_t>(first, layout_.plane_bytes) + value_bias();
    case VoxelType::kFloat32:
      return element<float>(first, layout_.plane_bytes);
  }
  return 0;
}

double longest_slab_step_mm(const VolumeGeometry& geometry) {
  const glm::dmat3 linear(geometry.index_from_world());
  const glm::dvec3 slices_per_mm(linear[0].z, linear[1].z, linear[2].z);
  return 2 * kMostOverhang / glm::length(slices_per_mm);
}

const char* name_of(VoxelType type) {
  switch (type) {
    case VoxelType::kUInt8:
      return "uint8";
    case VoxelType::kInt8:
      return "int8";
    case VoxelType::kUInt16:
      return "uint16";
    case VoxelType::kInt16:
      return "int16";
    case VoxelType::kFloat32:
      return "float32";
  }
  return "unknown";
}

}  // namespace goldthread
