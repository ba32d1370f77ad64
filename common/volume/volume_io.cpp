// SPDX-License-Identifier: Apache-2.0
#include "common/volume/volume_io.h"

#include "common/volume/itk_volume.h"
#include "common/volume/volume_checks.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;

Result<LoadedVolume> open_volume(const fs::path& path, const LoadOptions& options,
                                 bool header_only) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) return failure_of(path, "there is no such file", "check the path");
  if (is_itk_file_name(path)) return load_itk_volume(path, options, header_only);
  return failure_of(path, "its name ends like no volume format that is known",
                    "known are .nii .nii.gz .nrrd .mha .vtk .tif .vdb .raw and DICOM folders");
}

}  // namespace

Result<LoadedVolume> load_volume(const fs::path& path, const LoadOptions& options) {
  return open_volume(path, options, false);
}

Result<VolumeInfo> probe_volume(const fs::path& path, const LoadOptions& options) {
  auto loaded = open_volume(path, options, true);
  if (!loaded) return loaded.failure();
  return std::move(loaded->info);
}

}  // namespace goldthread
