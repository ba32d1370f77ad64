// SPDX-License-Identifier: Apache-2.0
#pragma once
// The kernels that exist, and how one is found. A kernel casts a span of rays, one ray per SIMD
// lane, for one kind of voxel and one set of features; which instruction set runs it is decided
// once per call, by Highway. To add a feature: a flag here, an `if constexpr` in ray_march-inl.h,
// and a line in kernel_unit-inl.h.
//
//   scene ──commit──► Features, Storage ──find_kernel──► Kernel ──cast(arguments)──► samples
//
//   kernel_unit-inl.h            a unit: all combinations of features for one kind of voxel
//   └ cast-inl.h                 positions to packets, packets to samples
//     ├ ray_packet-inl.h         a ray per lane, set up in double, segments counted from the camera
//     ├ ray_march-inl.h          emission and absorption
//     │ ├ cell_walk-inl.h        leaps over empty cells
//     │ ├ field-inl.h            values and gradients
//     │ │ ├ interpolation-inl.h  both are trilinear between voxels
//     │ │ ├ window-inl.h         a packet's voxels by permutations in registers
//     │ │ └ lone_voxels-inl.h    those of rays too far apart for that, lane by lane
//     │ ├ transfer-inl.h         value to colour and opacity
//     │ ├ shading-inl.h          Phong
//     │ └ accumulation-inl.h     front to back
//     ├ surface_march-inl.h      isosurfaces, alone or with emission and absorption
//     │ └ cell_cubic-inl.h       the field along a ray inside one cell
//     └ greatest_value-inl.h     maximum intensity projection

#include <string>
#include <vector>

#include "worker/kernels/kernel_types.h"

namespace goldthread {

/// What the scene needs of a ray. What is off is not compiled into the kernel.
struct Features {
  bool dvr = false;          ///< emission and absorption
  bool shading = false;      ///< Phong: gradients are computed
  bool isosurfaces = false;  ///< one or several, opaque or translucent
  bool mip = false;          ///< the greatest value alone
  bool operator==(const Features&) const = default;
};

/// How a voxel lies in memory. Signed integers are stored with their sign flipped, as unsigned.
enum class Storage : std::uint8_t { kUInt8, kUInt16, kFloat32 };

struct Kernel {
  Features features;
  Storage storage = Storage::kUInt8;
  /// All kernels of one unit (a .cpp file); picks by the features.
  CastCounts (*unit)(Features features, const CastArguments& arguments) = nullptr;

  CastCounts cast(const CastArguments& arguments) const { return unit(features, arguments); }
};

Storage storage_of(VoxelType type);

/// The features must be a combination that a scene can have: mip alone, or dvr and isosurfaces,
/// one or both, shaded or not.
Kernel find_kernel(Features features, Storage storage);

/// "dvr", "shading", "isosurfaces", "mip".
std::vector<std::string> names_of(Features features);

/// The instruction set that kernels run on, "AVX3": the best one that this machine has.
std::string instruction_set();

/// The instruction sets that were compiled and that this machine has, best first.
std::vector<std::string> instruction_sets();

/// Restricts every later cast of this process to one of instruction_sets(); "" lifts it. For tests.
void force_instruction_set(const std::string& name);

}  // namespace goldthread
