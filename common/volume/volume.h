// SPDX-License-Identifier: Apache-2.0
#pragma once
// A regular volume in memory: its geometry, its statistics, and its voxels in their own type in
// columns, with the value range of each 8×8×8 cell. A Volume only views memory that somebody keeps.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "common/volume/column_layout.h"

namespace goldthread {

/// The voxel types that are kept as they are. Anything else becomes kFloat32, and that is said.
enum class VoxelType : std::uint8_t { kUInt8, kInt8, kUInt16, kInt16, kFloat32 };

constexpr std::size_t bytes_per_voxel(VoxelType type) {
  switch (type) {
    case VoxelType::kUInt8:
    case VoxelType::kInt8:
      return 1;
    case VoxelType::kUInt16:
    case VoxelType::kInt16:
      return 2;
    case VoxelType::kFloat32:
      return 4;
  }
  return 0;
}

/// Where the voxels lie: centre of voxel (i,j,k) = origin + direction · (spacing ∘ (i,j,k)), LPS
/// mm.
struct VolumeGeometry {
  glm::ivec3 size{0, 0, 0};
  glm::dvec3 spacing_mm{1, 1, 1};
  glm::dvec3 origin_mm{0, 0, 0};
  glm::dmat3 direction{1};  ///< columns are the world directions of i, j and k; not singular
  bool operator==(const VolumeGeometry&) const = default;
  static constexpr auto fields() {
    return std::tuple{&VolumeGeometry::size, &VolumeGeometry::spacing_mm,
                      &VolumeGeometry::origin_mm, &VolumeGeometry::direction};
  }

  /// Affine maps between voxel indices (centres at integers) and world millimetres.
  glm::dmat4 world_from_index() const;
  glm::dmat4 index_from_world() const;
  std::size_t voxel_count() const {
    return std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z);
  }
};

/// What is known of a volume without holding its voxels.
struct VolumeInfo {
  std::string file;
  std::string format;                  ///< "NIfTI", "NRRD", "OpenVDB", "raw", …
  std::string stored_type;             ///< as the file has it, "uint8", "double", …
  VoxelType type = VoxelType::kUInt8;  ///< as it is held in memory
  int components = 1;                  ///< in the file
  int component = 0;                   ///< the one that is held
  VolumeGeometry geometry;
  double minimum = 0;  ///< of the finite voxels; 0 if there is none
  double maximum = 0;
  std::uint64_t not_finite = 0;          ///< voxels that are NaN or infinite; they count as empty
  std::vector<std::uint64_t> histogram;  ///< 256 equal bins over [minimum, maximum]
  std::vector<std::string> notes;        ///< what the user should know ("double kept as float32")
  static constexpr auto fields() {
    return std::tuple{&VolumeInfo::file,       &VolumeInfo::format,     &VolumeInfo::stored_type,
                      &VolumeInfo::type,       &VolumeInfo::components, &VolumeInfo::component,
                      &VolumeInfo::geometry,   &VolumeInfo::minimum,    &VolumeInfo::maximum,
                      &VolumeInfo::not_finite, &VolumeInfo::histogram,  &VolumeInfo::notes};
  }
};

/// Least and greatest stored value of the voxels that a trilinear sample inside a cell can touch
/// (8 cells' voxels and one more on the upper side of each axis), NaN and Inf left out.
/// An empty cell (no finite voxel) has minimum > maximum. No flag says that a cell also holds
/// voxels that are not finite: a sample that touches one is empty, and any other lies inside the
/// range, so that what the range proves about a cell (nothing to see, no crossing) holds with them
/// as well.
struct CellRange {
  float minimum;
  float maximum;
};

/// Voxels in columns and the ranges of their cells, in one block of memory that starts with the
/// voxels: [voxels, a multiple of 64 bytes][CellRange × cell count].
/// int8 and int16 are stored with the sign bit flipped, so that kernels see unsigned only:
/// value = stored + value_bias(). Float voxels that are not finite are stored as a quiet NaN, so
/// that kernels test for one thing only. Beyond the volume's border its outermost voxels are
/// repeated.
/// A Volume may be a slab: its info is that of the whole, and of voxels and cells it holds a part.
class Volume {
 public:
  Volume() = default;
  /// `memory` must hold block_bytes(info) bytes, aligned to 64, and lives as long as the Volume.
  Volume(VolumeInfo info, std::shared_ptr<const std::byte> memory);
  Volume(VolumeInfo info, const Slab& slab, std::shared_ptr<const std::byte> memory);

  static std::size_t block_bytes(const VolumeGeometry& geometry, VoxelType type);
  static std::size_t block_bytes(const VolumeGeometry& geometry, VoxelType type, const Slab& slab);
  /// Where the CellRanges begin in the block.
  static std::size_t cells_offset(const VolumeGeometry& geometry, VoxelType type, const Slab& slab);
  /// Cells along each axis of the whole volume.
  static glm::ivec3 cell_counts(const VolumeGeometry& geometry);

  const VolumeInfo& info() const { return info_; }
  const ColumnLayout& layout() const { return layout_; }
  const std::byte* voxels() const { return memory_.get(); }
  const std::shared_ptr<const std::byte>& memory() const { return memory_; }
  const Slab& slab() const { return slab_; }
  bool is_whole() const { return goldthread::is_whole(slab_, info_.geometry.size.z); }
  /// The layers of cells() along z: all, or of a slab those around its own too, whose cells may
  /// hold anything.
  LayerRange layers() const { return known_layers(slab_, info_.geometry.size.z); }
  /// Cells in x-fastest order, layer by layer; cell c covers voxel indices [8c, 8c+8].
  std::span<const CellRange> cells() const;
  glm::ivec3 cell_counts() const { return cell_counts(info_.geometry); }
  /// What to add to a stored number to get the data value: −128, −32768 or 0.
  double value_bias() const;
  /// The data value of one voxel; indices must lie inside what is held. Slow: for tests and tools.
  double at(int i, int j, int k) const;

 private:
  VolumeInfo info_;
  Slab slab_;
  ColumnLayout layout_;
  std::shared_ptr<const std::byte> memory_;
};

constexpr std::size_t kBlockAlignment = 64;

/// Slabs hold so much of their neighbours, in slices, as half a segment may reach beyond a border.
constexpr double kMostOverhang = 0.95;
/// The longest step of rays through slabs of a volume, mm.
double longest_slab_step_mm(const VolumeGeometry& geometry);

/// "uint8", "int16", "float32" …
const char* name_of(VoxelType type);

}  // namespace goldthread
