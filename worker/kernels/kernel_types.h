// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a kernel reads: the committed scene and the view as plain numbers, without SIMD types.
// Values are in the stored domain of the voxels (value_bias already taken off), positions in voxel
// indices, lengths in millimetres or, along a ray, in steps.

#include <cstdint>
#include <span>
#include <vector>

#include "common/tile/sample.h"
#include "common/volume/volume.h"
#include "worker/sample_source.h"
#include "worker/slabs/stage.h"

namespace goldthread {

/// ColumnLayout as plain numbers. Coordinates are the whole volume's, of a slab too.
struct FieldLayout {
  const std::uint8_t* voxels = nullptr;  ///< where slice 0 lies, or would
  std::int32_t size[3] = {0, 0, 0};      ///< voxels, each at least 2
  /// Whatever rounding does, no position lies outside these: 0 and the greatest float below size −
  /// 1; along z what the slab holds.
  float lower[3] = {0, 0, 0}, upper[3] = {0, 0, 0};
  /// Least and greatest stored coordinates where a window begins; and nothing, for vectors of four.
  alignas(16) std::int32_t first_origin[4] = {0, 0, 0, 0};
  alignas(16) std::int32_t last_origin[4] = {0, 0, 0, 0};
  std::int64_t plane_bytes = 0, column_bytes = 0, row_bytes = 0;
};

/// In CellGrid::distances.
constexpr std::uint8_t kMostCellDistance = 127;
constexpr std::uint8_t kCellIsVisible = 128;

/// Cells of 8³ voxels, for leaping over emptiness. Pointers as if layer 0 were there.
struct CellGrid {
  std::int32_t counts[3] = {0, 0, 0};
  const std::uint8_t* distances = nullptr;  ///< of cell_distances()
  const CellRange* ranges = nullptr;
};

/// Which segments of a ray belong to a slab: those whose middle has low ≤ z < high, in voxels. So
/// each belongs to one slab, and what a ray gathers from slab to slab is to the bit what it gathers
/// in the whole volume.
struct SlabBorders {
  bool is_whole = true;  ///< there are no others
  double low = 0;        ///< −∞ of the first slab
  double high = 0;       ///< +∞ of the last one
};

/// The transfer function as few segments of value, which are kept in registers: segment i holds
/// from start[i] to start[i+1], the first also before, the last also behind. With w = value −
/// start: colour is a line in w, opacity of a segment of full length a cubic, off by less than 2e-7
/// of itself, and exactly 0 where extinction is.
struct TransferSegments {
  static constexpr int kMost = 16;
  int count = 0;  ///< 0: more would be needed; then the rows serve
  float start[kMost] = {};
  float color[3][2][kMost] = {};  ///< constant and linear coefficient
  float opacity[4][kMost] = {};   ///< constant to cubic coefficient

  /// Equal buckets of value, to find a segment without a search.
  static constexpr int kBuckets = 64;
  bool has_buckets = false;  ///< at most one segment starts inside each bucket
  float first_bucket = 0, buckets_per_value = 0;
  std::uint8_t bucket[kBuckets] = {};  ///< the segment in which it begins
  float end[kMost] = {};               ///< of each segment; the last one has none
};

/// The transfer function as rows of red, green, blue and extinction (1/mm) at equal distances of
/// value, joined linearly; and as segments.
struct TransferTable {
  const float* rows = nullptr;
  const float* extinctions = nullptr;  ///< of the rows, once more by themselves
  const float* opacities = nullptr;  ///< of a segment of full length: 1 − e^(−extinction·step)
  const TransferSegments* segments = nullptr;
  float first_value = 0;
  float rows_per_value = 0;
  float last_row = 1;  ///< index of the last row, at least 1
};

struct SurfaceTerm {
  float value = 0;
  float color[3] = {0, 0, 0};
  float opacity = 1;
};

/// Phong's coefficients; matrices are row by row.
struct PhongTerm {
  float ambient = 0;
  float shininess = 1;
  float normal_from_gradient[9] = {};  ///< inverse transpose of world_from_index, up to a factor
  float world_from_index[9] = {};      ///< relative to voxel (0, 0, 0), mm
};

/// A light with the material's coefficients multiplied in.
struct LightTerm {
  bool is_point = false;
  float vector[3] = {0, 0,
                     0};  ///< towards the light; of a point light its place from voxel (0,0,0), mm
  float diffuse[3] = {0, 0, 0};
  float specular[3] = {0, 0, 0};
};

/// Everything that does not depend on the camera.
struct KernelScene {
  FieldLayout field;
  SlabBorders slab;
  CellGrid cells;
  TransferTable transfer;
  std::vector<SurfaceTerm> surfaces;  ///< in ascending order of value
  PhongTerm phong;
  double step_mm = 1;  ///< length of a full segment
};

/// The camera in index space: the ray through pixel (x, y) starts in `origin` and runs along
/// forward + u·right + v·up, u = (x − centre_x)·scale, v = (centre_y − y)·scale, divided by its
/// length in the world, √(1 + u² + v²).
struct KernelView {
  double origin[3] = {0, 0, 0};
  double forward[3] = {0, 0, 0};
  double right[3] = {0, 0, 0};
  double up[3] = {0, 0, 0};
  double centre_x = 0;
  double centre_y = 0;
  double scale = 0;
  std::vector<LightTerm> lights;
};

struct CastArguments {
  const KernelScene& scene;
  const KernelView& view;
  std::span<const PixelPosition> positions;
  std::span<Sample> samples;          ///< as many as positions
  std::span<std::uint32_t> surfaces;  ///< as many, filled with 0; or none: not wanted
  Stage stage = {};
};

}  // namespace goldthread
