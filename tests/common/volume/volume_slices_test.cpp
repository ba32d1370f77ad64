// SPDX-License-Identifier: Apache-2.0
// Slices of a file are those of the whole volume, whether its voxels lie in it as they are or not.

#include "common/volume/volume_slices.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "volume_writers.h"

namespace goldthread {
namespace {

using namespace testing_files;

/// All slices, read two at a time.
std::vector<std::byte> all_slices(const VolumeSlices& slices) {
  const glm::ivec3 size = slices.info.geometry.size;
  const std::size_t slice =
      std::size_t(size.x) * std::size_t(size.y) * bytes_per_voxel(slices.info.type);
  std::vector<std::byte> bytes(slice * std::size_t(size.z));
  for (int z = 0; z < size.z; z += 2) {
    const int count = std::min(2, size.z - z);
    const auto failure = slices.read(
        z, count, std::span(bytes).subspan(slice * std::size_t(z), slice * std::size_t(count)));
    EXPECT_FALSE(failure) << failure->line();
  }
  return bytes;
}

void expect_slices(const std::filesystem::path& file, bool in_parts) {
  const auto whole = load_volume(file);
  ASSERT_TRUE(whole) << whole.failure().line();
  const auto slices = open_slices(file);
  ASSERT_TRUE(slices) << slices.failure().line();
  EXPECT_EQ(slices->reads_parts, in_parts) << file;
  EXPECT_EQ(slices->info.geometry, whole->info.geometry) << file;
  EXPECT_EQ(slices->info.type, whole->info.type) << file;
  const auto bytes = all_slices(*slices);
  const auto expected = whole->voxels();
  ASSERT_EQ(bytes.size(), expected.size());
  EXPECT_EQ(std::memcmp(bytes.data(), expected.data(), bytes.size()), 0) << file;
}

TEST(VolumeSlices, FormatsWithoutCompressionAreReadInParts) {
  const TemporaryFolder folder;
  for (const StoredType type : {StoredType::kUInt8, StoredType::kInt16, StoredType::kFloat32,
                                StoredType::kFloat64, StoredType::kUInt32}) {
    for (const char* ending : {".nii", ".nrrd", ".mha", ".mhd"}) {
      const auto file = folder / (std::string("ramp-") + name_of(type) + ending);
      write_with_itk(file, oblique_ramp(type));
      expect_slices(file, true);
    }
  }
  const auto raw = folder / "ramp_5x4x3_int16.raw";
  const Content content = oblique_ramp(StoredType::kInt16);
  std::ofstream(raw, std::ios::binary)
      .write(reinterpret_cast<const char*>(content.bytes.data()),
             std::streamsize(content.bytes.size()));
  expect_slices(raw, true);
}

TEST(VolumeSlices, OthersAreReadWhole) {
  const TemporaryFolder folder;
  for (const char* ending : {".nii.gz", ".vtk"}) {
    const auto file = folder / (std::string("ramp") + ending);
    write_with_itk(file, oblique_ramp(StoredType::kInt16));
    expect_slices(file, false);
  }
  const auto vectors = folder / "vectors.nrrd";
  write_with_itk(vectors, oblique_ramp(StoredType::kUInt8, 3));
  expect_slices(vectors, false);
}

TEST(VolumeSlices, AHeaderThatIsNotUnderstoodIsNotGuessed) {
  const TemporaryFolder folder;
  const auto write = [&](const std::string& name, const std::string& header, std::size_t bytes) {
    std::ofstream file(folder / name, std::ios::binary);
    file << header;
    for (std::size_t i = 0; i < bytes; ++i) file.put(char(i * 7));
  };
  const std::string sizes = "type: short\ndimension: 3\nsizes: 4 3 5\n";
  write("big.nrrd", "NRRD0004\n" + sizes + "endian: big\nencoding: raw\n\n", 120);
  expect_slices(folder / "big.nrrd", false);
  write("skip.nrrd", "NRRD0004\n" + sizes + "endian: little\nencoding: raw\nbyte skip: 4\n\n", 124);
  expect_slices(folder / "skip.nrrd", false);
  write("text.nrrd",
        "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 1 2\nencoding: ascii\n\n1 2 3 4\n", 0);
  expect_slices(folder / "text.nrrd", false);
}

TEST(VolumeSlices, BooleansOfAMetaImageAreReadAsItsLibraryReadsThem) {
  const TemporaryFolder folder;
  const auto file = folder / "big.mha";
  std::ofstream stream(file, std::ios::binary);
  stream << "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = T\n"
            "CompressedData = False\nDimSize = 4 3 5\nElementType = MET_SHORT\n"
            "ElementDataFile = LOCAL\n";
  for (int i = 0; i < 120; ++i) stream.put(char(i * 7));
  stream.close();
  expect_slices(file, false);
}

TEST(VolumeSlices, AFileThatGrewShorterIsAFailure) {
  const TemporaryFolder folder;
  const auto file = folder / "ramp_16x16x16_uint8.raw";
  std::ofstream(file, std::ios::binary) << std::string(16 * 16 * 16, 'x');
  const auto slices = open_slices(file);
  ASSERT_TRUE(slices);
  std::filesystem::resize_file(file, 1000);
  std::vector<std::byte> slice(256);
  EXPECT_FALSE(slices->read(0, 1, slice));
  const auto failure = slices->read(10, 1, slice);
  ASSERT_TRUE(failure);
  EXPECT_NE(failure->what.find("reading stopped"), std::string::npos);
}

TEST(VolumeSlices, AFileThatIsNotThereIsAFailure) {
  EXPECT_FALSE(open_slices("/nonexistent/volume.nrrd"));
}

}  // namespace
}  // namespace goldthread
