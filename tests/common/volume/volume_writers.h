// SPDX-License-Identifier: Apache-2.0
#pragma once
// Small volume files for tests: written by ITK, so that the readers are tested against another's
// idea of each format, or byte by byte where no library writes what a test needs.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/volume/stored_type.h"
#include "common/volume/volume.h"

namespace goldthread::testing_files {

/// A folder of its own that is gone with it.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// What a file shall hold: interleaved components, x fastest, in `type`.
struct Content {
  VolumeGeometry geometry;
  StoredType type = StoredType::kUInt8;
  int components = 1;
  int steps = 1;  ///< volumes one after the other; more than one add a fourth axis
  std::vector<std::byte> bytes;
};

/// A ramp over all of `type`'s range in an oblique grid of 5×4×3 voxels of 0.5 × 1.25 × 3 mm.
Content oblique_ramp(StoredType type, int components = 1, int steps = 1);

/// The number at `index` of `content.bytes`.
double number_at(const Content& content, std::size_t index);

/// Writes with the ITK writer for the name's ending.
void write_with_itk(const std::filesystem::path& file, const Content& content);

/// A slice of a DICOM series as a scanner writes it, uncompressed.
struct DicomSlice {
  std::string series = "1.2.3";
  std::string description = "test";
  int number = 1;
  glm::dvec3 position{0, 0, 0};
  glm::dvec3 row{1, 0, 0}, column{0, 1, 0};
  glm::dvec2 spacing{1, 1};
  glm::ivec2 size{4, 3};
  double slope = 1, intercept = 0;
  std::vector<std::int16_t> pixels;
};
void write_dicom(const std::filesystem::path& file, const DicomSlice& slice);

std::vector<char> bytes_of_file(const std::filesystem::path& file);
void write_bytes(const std::filesystem::path& file, std::span<const char> bytes);
void write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace goldthread::testing_files
