// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which DICOM files make a volume, in which order, and where they lie; internal to volume_io. Reads
// headers only, with GDCM.

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/volume/volume.h"

namespace goldthread {

/// Slices in ascending order along the third axis of `geometry`, whose size.z is their number.
struct DicomSeries {
  std::vector<std::filesystem::path> files;
  VolumeGeometry geometry;
  int frames = 1;  ///< of the only file; more than one are a volume by themselves
  std::vector<std::string> notes;
};

/// Whether a file begins as DICOM files do ("DICM" after 128 bytes).
bool is_dicom_file(const std::filesystem::path& file);

/// `path` is a folder, of which the series with the most slices is taken, or one file of a series.
/// Slices are ordered by their position along the normal of the first one. Their distance is that
/// of the outermost two shared out, and the third direction goes from the first to the last, so
/// that a tilted gantry is kept.
Result<DicomSeries> find_dicom_series(const std::filesystem::path& path);

}  // namespace goldthread
