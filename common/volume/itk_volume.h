// SPDX-License-Identifier: Apache-2.0
#pragma once
// NIfTI, NRRD, MetaImage, legacy VTK and DICOM, through ITK; internal to volume_io. With
// `header_only` the voxels are not read and a LoadedVolume has its info alone.

#include <filesystem>

#include "common/base/result.h"
#include "common/volume/volume_io.h"

namespace goldthread {

/// Whether the name of `file` is one of a format that load_itk_file reads.
bool is_itk_file_name(const std::filesystem::path& file);

/// One file that holds a volume, of the format that its name says.
Result<LoadedVolume> load_itk_file(const std::filesystem::path& file, const LoadOptions& options,
                                   bool header_only);

/// A DICOM series: a folder, or one of its files.
Result<LoadedVolume> load_dicom_series(const std::filesystem::path& path,
                                       const LoadOptions& options, bool header_only);

}  // namespace goldthread
