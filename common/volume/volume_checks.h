// SPDX-License-Identifier: Apache-2.0
#pragma once
// What every reader checks before it believes a header or asks for memory; internal to volume_io.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "common/base/result.h"
#include "common/volume/file_names.h"
#include "common/volume/stored_type.h"
#include "common/volume/volume_io.h"

namespace goldthread {

/// Size as a file has it, before it is known to fit into 32 bits.
using FileSize3 = std::array<std::uint64_t, 3>;

/// A Failure of `file`.
Failure failure_of(const std::filesystem::path& file, std::string what, std::string mend);

/// Fills geometry.size from `size` and checks all of `geometry`: each edge 1 … 2^20, at most 2^40
/// voxels, spacing positive and finite, origin finite, direction finite and not singular.
std::optional<Failure> check_geometry(const std::filesystem::path& file, const FileSize3& size,
                                      VolumeGeometry& geometry);

/// Whether `available` bytes of a file can hold `data_bytes` of data, at best compressed by
/// deflate, which never shrinks to less than 1/1032.
std::optional<Failure> check_file_holds(const std::filesystem::path& file, DataBytes available,
                                        std::uint64_t data_bytes);

/// The component to hold, chosen or 0; adds to info what there is to note.
std::optional<Failure> choose_component(const LoadOptions& options, VolumeInfo& info);

/// Notes that `type` becomes another one in memory, if it does; sets info.type and stored_type.
void set_types(StoredType type, VolumeInfo& info);

/// Memory for `bytes`, if the machine has that much to give beside the columns made from it.
Result<std::unique_ptr<std::byte[]>> allocate_voxels(const std::filesystem::path& file,
                                                     std::uint64_t bytes);

}  // namespace goldthread
