// SPDX-License-Identifier: Apache-2.0
#pragma once
// A part of a volume for those who cannot hold all of it: layers of cells along z, the axis along
// which files are written, so that a slab is one run of a file's bytes. Around its own voxels a
// slab holds two more slices on either side: rays are handed over up to half a step beyond its
// border, and gradients look one voxel further.

#include <algorithm>
#include <cstdint>
#include <tuple>

namespace goldthread {

constexpr int kCellEdge = 8;  ///< voxels of a cell

/// Layers of cells [first_layer, last_layer) of a volume.
struct Slab {
  std::int32_t first_layer = 0;
  std::int32_t last_layer = 0;
  bool operator==(const Slab&) const = default;
  static constexpr auto fields() { return std::tuple{&Slab::first_layer, &Slab::last_layer}; }
};

/// [first, last) of something along z.
struct LayerRange {
  int first = 0;
  int last = 0;
  int count() const { return last - first; }
};

constexpr int layers_of(int slices) { return (slices + kCellEdge - 1) / kCellEdge; }

/// All of a volume of so many slices.
constexpr Slab whole_slab(int slices) { return {0, layers_of(slices)}; }
/// For what a peer says.
constexpr bool is_slab_of(const Slab& slab, int slices) {
  return slab.first_layer >= 0 && slab.first_layer < slab.last_layer &&
         slab.last_layer <= layers_of(slices);
}
constexpr bool is_whole(const Slab& slab, int slices) { return slab == whole_slab(slices); }

/// Slab `index` of `count`, as even as whole layers allow; `count` must not exceed layers_of().
constexpr Slab slab_of(int slices, int index, int count) {
  const std::int64_t layers = layers_of(slices);
  return {std::int32_t(layers * index / count), std::int32_t(layers * (index + 1) / count)};
}

/// The slices that a slab holds in "stored" coordinates, voxel + 1: of the whole volume one more on
/// either side, which repeats the border.
constexpr LayerRange stored_slices(const Slab& slab, int slices) {
  return {std::max(slab.first_layer * kCellEdge - 1, 0),
          std::min(slab.last_layer * kCellEdge + 4, slices + 2)};
}

/// The layers whose cells a slab knows of: its own and, as cells that may hold anything, those
/// beside it.
constexpr LayerRange known_layers(const Slab& slab, int slices) {
  return {std::max(slab.first_layer - 1, 0), std::min(slab.last_layer + 1, layers_of(slices))};
}

/// The voxels that are counted as a slab's own: each belongs to one slab.
constexpr LayerRange own_slices(const Slab& slab, int slices) {
  return {slab.first_layer * kCellEdge, std::min(slab.last_layer * kCellEdge, slices)};
}

}  // namespace goldthread
