// SPDX-License-Identifier: Apache-2.0
#pragma once
// Volume files to voxels in memory. A file is hostile until read: whatever it holds, the answer is
// a LoadedVolume or one Failure that names the file, never an exception, a message on stderr, or an
// allocation larger than the machine's memory.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "common/base/result.h"
#include "common/volume/volume.h"

namespace goldthread {

struct LoadOptions {
  std::optional<int> component;  ///< of a multi-component file; absent: 0, with a note
  std::string grid;              ///< of an OpenVDB file; empty: its first scalar grid
  /// Called with the fraction done (0…1, ascending), from whichever thread loads.
  std::function<void(double fraction)> progress;
};

/// What was read: info without statistics, and the voxels in info.type, x fastest, then y, then z.
struct LoadedVolume {
  VolumeInfo info;
  std::unique_ptr<std::byte[]> memory;
  std::size_t first_byte = 0;  ///< where the voxels begin in it: a multiple of their size
  std::size_t byte_count = 0;
  std::span<const std::byte> voxels() const { return {memory.get() + first_byte, byte_count}; }
};

/// Reads a whole volume. Formats: NIfTI, NRRD, MetaImage, DICOM series (a folder, or one of its
/// files), TIFF (a stack, or a folder of numbered slices), legacy VTK, OpenVDB, and raw voxels
/// whose name tells their shape (`name_256x256x108_1x1x1.5mm_int16.raw`, little endian).
Result<LoadedVolume> load_volume(const std::filesystem::path& path,
                                 const LoadOptions& options = {});

/// The same info from the file's header alone, wherever the format has one.
Result<VolumeInfo> probe_volume(const std::filesystem::path& path, const LoadOptions& options = {});

}  // namespace goldthread
