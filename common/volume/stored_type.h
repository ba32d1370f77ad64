// SPDX-License-Identifier: Apache-2.0
#pragma once
// The number types that files use, and how they become the fewer types that a Volume holds.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "common/volume/volume.h"

namespace goldthread {

enum class StoredType : std::uint8_t {
  kUInt8,
  kInt8,
  kUInt16,
  kInt16,
  kUInt32,
  kInt32,
  kUInt64,
  kInt64,
  kFloat32,
  kFloat64
};

std::size_t bytes_of(StoredType type);
/// "uint8" … "float64", and back.
const char* name_of(StoredType type);
std::optional<StoredType> stored_type_named(std::string_view name);

/// The type in memory: 8 and 16 bits and float32 as they are, anything else float32.
VoxelType held_type(StoredType type);
/// The stored type that is held as it is.
StoredType stored_type(VoxelType type);

/// Takes one component out of interleaved ones and converts it to held_type(type). `from` holds
/// to.size() / bytes_per_voxel × components numbers and may begin where `to` begins; otherwise they
/// do not overlap.
void take_component(std::span<const std::byte> from, StoredType type, int components, int component,
                    std::span<std::byte> to);

/// Numbers of `type` · slope + intercept, as int16 (which they must fit) or float32.
void rescale(std::span<const std::byte> from, StoredType type, double slope, double intercept,
             VoxelType to_type, std::span<std::byte> to);

/// Held voxels of any type as floats, exactly.
void widen_to_float(std::span<const std::byte> from, VoxelType type, std::span<float> to);

}  // namespace goldthread
