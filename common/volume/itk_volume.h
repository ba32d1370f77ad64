// SPDX-License-Identifier: Apache-2.0
#pragma once
// NIfTI, NRRD, MetaImage, TIFF, legacy VTK and DICOM, through ITK; internal to volume_io.

#include <filesystem>

#include "common/base/result.h"
#include "common/volume/volume_io.h"

namespace goldthread {

/// Whether the name of `file` is one of a format read here.
bool is_itk_file_name(const std::filesystem::path& file);

/// load_volume and probe_volume for these formats; with `header_only`, voxels are not read and the
/// LoadedVolume has info alone.
Result<LoadedVolume> load_itk_volume(const std::filesystem::path& path, const LoadOptions& options,
                                     bool header_only);

}  // namespace goldthread
