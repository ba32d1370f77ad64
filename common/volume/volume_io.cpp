// SPDX-License-Identifier: Apache-2.0
#include "common/volume/volume_io.h"

#include "common/volume/dicom_series.h"
#include "common/volume/file_names.h"
#include "common/volume/itk_volume.h"
#include "common/volume/raw_volume.h"
#include "common/volume/tiff_volume.h"
#include "common/volume/vdb_volume.h"
#include "common/volume/volume_checks.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKnownFormats =
    "known are .nii .nii.gz .hdr .nrrd .nhdr .mha .mhd .vtk .tif .vdb .raw, DICOM files and "
    "folders";

Result<LoadedVolume> open_folder(const fs::path& folder, const LoadOptions& options,
                                 bool header_only) {
  if (!numbered_files(folder, {".tif", ".tiff"}).empty())
    return load_tiff_volume(folder, options, header_only);
  return load_dicom_series(folder, options, header_only);
}

Result<LoadedVolume> open_volume(const fs::path& path, const LoadOptions& options,
                                 bool header_only) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) return failure_of(path, "there is no such file", "check the path");
  if (fs::is_directory(status)) return open_folder(path, options, header_only);
  // A pipe or a device could keep a reader for ever.
  if (!fs::is_regular_file(status))
    return failure_of(path, "it is neither a file nor a folder", "name a volume file");
  if (has_ending(path, ".raw")) return load_raw_volume(path, options, header_only);
  if (has_ending(path, ".vdb")) return load_vdb_volume(path, options, header_only);
  if (has_ending(path, ".tif") || has_ending(path, ".tiff"))
    return load_tiff_volume(path, options, header_only);
  if (is_itk_file_name(path)) return load_itk_file(path, options, header_only);
  if (is_dicom_file(path)) return load_dicom_series(path, options, header_only);
  return failure_of(path, "its name ends like no format of volumes, and it is no DICOM file",
                    kKnownFormats);
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
