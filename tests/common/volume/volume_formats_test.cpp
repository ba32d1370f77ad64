// SPDX-License-Identifier: Apache-2.0
// What is peculiar to one format: raw names, NIfTI's scale, DICOM series, OpenVDB; and real data.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "common/volume/build_volume.h"
#include "common/volume/volume_io.h"
#include "common/volume/volume_report.h"
#include "tests/common/volume/volume_writers.h"

namespace goldthread {
namespace {

using testing::Contains;
using testing::HasSubstr;
using namespace testing_files;
namespace fs = std::filesystem;

template <class T>
T value_at(const LoadedVolume& loaded, std::size_t index) {
  T value;
  std::memcpy(&value, loaded.voxels().data() + index * sizeof(T), sizeof(T));
  return value;
}

TEST(RawVolume, TheNameTellsSizeSpacingAndType) {
  TemporaryFolder folder;
  const std::int16_t voxels[6] = {-1000, 0, 1, 2, 3, 32767};
  const fs::path file = folder / "ct_head_3x2x1_1x1x1.5mm_int16.raw";
  write_bytes(file, {reinterpret_cast<const char*>(voxels), sizeof voxels});
  const auto loaded = load_volume(file);
  ASSERT_TRUE(loaded.ok()) << loaded.failure().line();
  EXPECT_EQ(loaded->info.geometry.size, glm::ivec3(3, 2, 1));
  EXPECT_EQ(loaded->info.geometry.spacing_mm, glm::dvec3(1, 1, 1.5));
  EXPECT_EQ(loaded->info.geometry.origin_mm, glm::dvec3(-1, -0.5, 0));
  EXPECT_EQ(loaded->info.type, VoxelType::kInt16);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(value_at<std::int16_t>(*loaded, i), voxels[i]);
}

TEST(RawVolume, AnotherSizeThanTheNamesIsRefusedWithBothNumbers) {
  TemporaryFolder folder;
  const fs::path file = folder / "head_4x4x4_uint16.raw";
  write_text(file, std::string(127, 'x'));
  const auto loaded = load_volume(file);
  ASSERT_FALSE(loaded.ok());
  EXPECT_THAT(loaded.failure().what, HasSubstr("128"));
  EXPECT_THAT(loaded.failure().what, HasSubstr("127"));
}

TEST(RawVolume, ANameWithoutAShapeIsRefused) {
  TemporaryFolder folder;
  for (const char* name : {"head.raw", "head_4x4_uint8.raw", "head_4x4x4.raw",
                           "head_4x4x4_int7.raw", "head_0x4x4_uint8.raw", "head_-1x4x4_uint8.raw",
                           "_.raw", "x.raw", "h_99999999999999999999x1x1_uint8.raw",
                           "h_1x1x1_0x1x1mm_uint8.raw", "h_1x1x1_nanx1x1mm_uint8.raw"}) {
    write_text(folder / name, "x");
    EXPECT_FALSE(load_volume(folder / name).ok()) << name;
  }
}

// Writes a slope and an intercept into a NIfTI file.
void set_scale(const fs::path& file, float slope, float intercept) {
  auto bytes = bytes_of_file(file);
  std::memcpy(bytes.data() + 112, &slope, 4);
  std::memcpy(bytes.data() + 116, &intercept, 4);
  write_bytes(file, bytes);
}

TEST(NiftiScale, WholeNumbersThatFitStayInt16AndOthersBecomeFloat) {
  TemporaryFolder folder;
  const Content content = oblique_ramp(StoredType::kUInt8);
  const fs::path file = folder / "scaled.nii";
  write_with_itk(file, content);
  set_scale(file, 2, -1024);
  const auto whole = load_volume(file);
  ASSERT_TRUE(whole.ok()) << whole.failure().line();
  EXPECT_EQ(whole->info.type, VoxelType::kInt16);
  EXPECT_THAT(whole->info.notes, Contains(HasSubstr("held as int16")));
  set_scale(file, 0.5F, 0.25F);
  const auto part = load_volume(file);
  ASSERT_TRUE(part.ok());
  EXPECT_EQ(part->info.type, VoxelType::kFloat32);
  for (std::size_t i = 0; i < content.geometry.voxel_count(); ++i) {
    EXPECT_EQ(value_at<std::int16_t>(*whole, i), number_at(content, i) * 2 - 1024);
    EXPECT_EQ(value_at<float>(*part, i), number_at(content, i) * 0.5 + 0.25);
  }
}

// An oblique series of `count` slices 2.5 mm apart, in files whose names say nothing of the order.
// Voxel (i, j, k) holds 100·k + 10·j + i.
void write_series(const TemporaryFolder& folder, const std::string& series, int count) {
  for (int k = 0; k < count; ++k) {
    DicomSlice slice;
    slice.series = series;
    slice.number = count - k;  // against the positions
    slice.row = {0.6, 0.8, 0};
    slice.column = {0, 0, -1};
    slice.spacing = {0.5, 0.75};
    slice.intercept = -1024;
    const glm::dvec3 normal = glm::cross(slice.row, slice.column);
    slice.position = glm::dvec3(-20, 30, 40) + 2.5 * k * normal;
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 4; ++i) slice.pixels.push_back(std::int16_t(100 * k + 10 * j + i));
    write_dicom(folder / (series + "-" + std::to_string(k * 7 % 5) + std::to_string(k)), slice);
  }
}

TEST(DicomSeries, IsSortedByPositionAndHoldsDataValues) {
  TemporaryFolder folder;
  write_series(folder, "1.2.3", 5);
  for (const fs::path& path : {folder.path(), folder / "1.2.3-00"}) {
    const auto loaded = load_volume(path);
    ASSERT_TRUE(loaded.ok()) << loaded.failure().line();
    const VolumeGeometry& geometry = loaded->info.geometry;
    EXPECT_EQ(geometry.size, glm::ivec3(4, 3, 5));
    EXPECT_NEAR(geometry.spacing_mm.x, 0.5, 1e-9);
    EXPECT_NEAR(geometry.spacing_mm.y, 0.75, 1e-9);
    EXPECT_NEAR(geometry.spacing_mm.z, 2.5, 1e-5);
    EXPECT_EQ(geometry.origin_mm, glm::dvec3(-20, 30, 40));
    EXPECT_NEAR(glm::length(geometry.direction[0] - glm::dvec3(0.6, 0.8, 0)), 0, 1e-9);
    EXPECT_NEAR(glm::length(geometry.direction[1] - glm::dvec3(0, 0, -1)), 0, 1e-9);
    EXPECT_NEAR(glm::length(geometry.direction[2] - glm::dvec3(-0.8, 0.6, 0)), 0, 1e-5);
    ASSERT_EQ(loaded->info.type, VoxelType::kInt16);
    for (int k = 0; k < 5; ++k)
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 4; ++i)
          EXPECT_EQ(value_at<std::int16_t>(*loaded, std::size_t((k * 3 + j) * 4 + i)),
                    100 * k + 10 * j + i - 1024);
  }
}

TEST(DicomSeries, TheLargestOfAFolderIsTakenAndTheOthersNamed) {
  TemporaryFolder folder;
  write_series(folder, "1.2.3", 2);
  write_series(folder, "1.2.4", 4);
  const auto loaded = load_volume(folder.path());
  ASSERT_TRUE(loaded.ok()) << loaded.failure().line();
  EXPECT_EQ(loaded->info.geometry.size.z, 4);
  EXPECT_THAT(loaded->info.notes, Contains(HasSubstr("another series")));
}

TEST(DicomSeries, ATruncatedSliceIsRefused) {
  TemporaryFolder folder;
  write_series(folder, "1.2.3", 1);
  const fs::path file = folder / "1.2.3-00";
  const auto whole = bytes_of_file(file);
  for (const std::size_t length :
       {std::size_t(0), std::size_t(140), whole.size() / 2, whole.size() - 9}) {
    write_bytes(file, {whole.data(), length});
    testing::internal::CaptureStderr();
    const auto loaded = load_volume(file);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_FALSE(loaded.ok()) << length;
  }
}

struct RealFile {
  const char* name;
  VoxelType type;
  glm::ivec3 size;
  double spacing_mm;
  glm::dvec3 origin_mm;
  double maximum;
};
class RealData : public testing::TestWithParam<RealFile> {};
INSTANTIATE_TEST_SUITE_P(
    Mricron, RealData,
    testing::Values(
        RealFile{"ch2", VoxelType::kUInt8, {181, 217, 181}, 1, {90, 125, -71}, 254},
        RealFile{"ch2better", VoxelType::kUInt8, {301, 370, 316}, 0.5, {75, 107, -69.5}, 130},
        RealFile{"inia19-t1-brain",
                 VoxelType::kFloat32,
                 {168, 206, 128},
                 0.5,
                 {42, 57.5, -30},
                 383.17547607421875}),
    [](const auto& instance) {
      return std::string(instance.param.name).substr(0, std::string(instance.param.name).find('-'));
    });

TEST_P(RealData, LoadsWithTheGeometryAndRangeOfItsHeader) {
  const RealFile& real = GetParam();
  const fs::path file =
      fs::path("/usr/share/mricron/templates") / (std::string(real.name) + ".nii.gz");
  if (!fs::exists(file)) GTEST_SKIP() << "the package mricron-data is not installed";
  const auto loaded = load_volume(file);
  ASSERT_TRUE(loaded.ok()) << loaded.failure().line();
  const auto volume = build_volume(loaded->info, loaded->voxels());
  const VolumeInfo& info = volume->info();
  EXPECT_EQ(info.type, real.type);
  EXPECT_EQ(info.geometry.size, real.size);
  EXPECT_EQ(info.geometry.spacing_mm, glm::dvec3(real.spacing_mm));
  EXPECT_EQ(info.geometry.origin_mm, real.origin_mm);
  EXPECT_EQ(info.geometry.direction, glm::dmat3({-1, 0, 0}, {0, -1, 0}, {0, 0, 1}));
  EXPECT_EQ(info.minimum, 0);
  EXPECT_NEAR(info.maximum, real.maximum, 1e-3);
  if (info.type == VoxelType::kUInt8) {
    EXPECT_LE(double(Volume::block_bytes(info.geometry, info.type)),
              1.30 * double(info.geometry.voxel_count()));
  }
}

VolumeInfo described() {
  VolumeInfo info;
  info.file = "head\n\x1b[2J.nii";
  info.format = "NIfTI";
  info.stored_type = "int16";
  info.type = VoxelType::kInt16;
  info.geometry.size = {64, 64, 32};
  info.minimum = -1024;
  info.maximum = 3071;
  info.not_finite = 0;
  for (std::uint64_t bin = 0; bin < 256; ++bin) info.histogram.push_back(bin * bin % 1000);
  info.notes = {"a note that is rather long, so that it must be broken into several lines of text"};
  return info;
}

TEST(VolumeReport, KeepsToItsColumnsAndToAscii) {
  for (const int columns : {40, 60, 80, 200}) {
    const std::string text = describe(described(), columns, false);
    std::size_t width = 0;
    for (const char c : text) {
      EXPECT_TRUE(c == '\n' || (c >= 0x20 && c < 0x7F)) << int(c);
      width = c == '\n' ? 0 : width + 1;
      EXPECT_LE(width, std::size_t(columns));
    }
  }
}

TEST(VolumeReport, TellsWhatAReaderLooksFor) {
  const std::string text = describe(described(), 100, true);
  for (const char* part : {"64 × 64 × 32", "-1024", "3071", "R→L", "A→P", "I→S", "int16", "█"})
    EXPECT_THAT(text, HasSubstr(part));
}

TEST(VolumeReport, AnObliqueVolumesMatrixIsShown) {
  VolumeInfo info = described();
  info.geometry.direction = glm::dmat3({0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1});
  EXPECT_THAT(describe(info, 80, true), HasSubstr("0.60000 -0.80000"));
}

}  // namespace
}  // namespace goldthread
