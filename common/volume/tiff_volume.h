// SPDX-License-Identifier: Apache-2.0
#pragma once
// TIFF stacks, through OpenImageIO; internal to volume_io. Not through ITK, whose TIFF reader
// writes beyond its memory where the pages of a damaged file differ in size.

#include <filesystem>

#include "common/base/result.h"
#include "common/volume/volume_io.h"

namespace goldthread {

/// The pages of one file, previews left out, or for a folder the first page of each of its .tif
/// files, in the order of the numbers in their names. TIFF does not tell the distance of slices.
Result<LoadedVolume> load_tiff_volume(const std::filesystem::path& path, const LoadOptions& options,
                                      bool header_only);

}  // namespace goldthread
