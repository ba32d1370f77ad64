// SPDX-License-Identifier: Apache-2.0
#pragma once
// Files by their names, and the files that belong to others; internal to volume_io.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace goldthread {

/// Whether the name ends with `ending` (lower case), in upper or lower case.
bool has_ending(const std::filesystem::path& file, std::string_view ending);

/// The files of a folder with one of these endings, in the order of the numbers in their names
/// (slice2 before slice10).
std::vector<std::filesystem::path> numbered_files(const std::filesystem::path& folder,
                                                  const std::array<const char*, 4>& endings);

/// Bytes of a file that may be voxels, as they are or perhaps compressed.
struct DataBytes {
  std::uint64_t bytes = 0;
  bool compressed = true;
};

/// Those of `file` behind its header, or of the file that a detached header (.hdr .nhdr .mhd)
/// names. Nothing where they are several; a Failure where it is not there.
Result<std::optional<DataBytes>> data_bytes_of(const std::filesystem::path& file);

}  // namespace goldthread
