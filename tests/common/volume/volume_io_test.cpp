// SPDX-License-Identifier: Apache-2.0
#include "common/volume/volume_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>

#include "common/volume/build_volume.h"
#include "tests/common/volume/volume_writers.h"

namespace goldthread {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using namespace testing_files;
namespace fs = std::filesystem;

double voxel(const LoadedVolume& loaded, std::size_t index) {
  Content held;
  held.type = stored_type(loaded.info.type);
  const auto voxels = loaded.voxels();
  held.bytes.assign(voxels.begin(), voxels.end());
  return number_at(held, index);
}

void expect_geometry(const VolumeGeometry& found, const VolumeGeometry& expected) {
  EXPECT_EQ(found.size, expected.size);
  for (int axis = 0; axis < 3; ++axis) {
    // NIfTI keeps its matrix in 32-bit floats.
    EXPECT_NEAR(found.spacing_mm[axis], expected.spacing_mm[axis], 1e-5);
    EXPECT_NEAR(found.origin_mm[axis], expected.origin_mm[axis], 1e-5);
    for (int row = 0; row < 3; ++row)
      EXPECT_NEAR(found.direction[axis][row], expected.direction[axis][row], 1e-6);
  }
}

// Each voxel of the first time step, of one component, as the nearest float where it is held so.
void expect_voxels(const LoadedVolume& loaded, const Content& content, int component = 0) {
  const std::size_t count = content.geometry.voxel_count();
  ASSERT_EQ(loaded.voxels().size(), count * bytes_per_voxel(loaded.info.type));
  for (std::size_t i = 0; i < count; ++i) {
    double expected =
        number_at(content, i * std::size_t(content.components) + std::size_t(component));
    if (loaded.info.type == VoxelType::kFloat32) expected = double(float(expected));
    EXPECT_EQ(voxel(loaded, i), expected) << i;
  }
}

std::string name_of_ending(const testing::TestParamInfo<const char*>& instance) {
  std::string name = instance.param;
  std::erase(name, '.');
  return name;
}

class EachFormat : public testing::TestWithParam<const char*> {
 protected:
  TemporaryFolder folder_;
  fs::path file() const { return folder_ / ("volume" + std::string(GetParam())); }
  bool has_direction() const { return GetParam() != std::string(".vtk"); }
  bool has_type(StoredType type) const {
    if (GetParam() == std::string(".tif"))
      return type == StoredType::kUInt8 || type == StoredType::kUInt16 ||
             type == StoredType::kInt16 || type == StoredType::kInt8 ||
             type == StoredType::kFloat32;
    return true;
  }
  Content content(StoredType type, int components = 1, int steps = 1) const {
    Content made = oblique_ramp(type, components, steps);
    if (!has_direction()) made.geometry.direction = glm::dmat3(1);
    return made;
  }
  bool is_tiff() const { return GetParam() == std::string(".tif"); }
};
INSTANTIATE_TEST_SUITE_P(Itk, EachFormat,
                         testing::Values(".nii", ".nii.gz", ".hdr", ".nrrd", ".nhdr", ".mha",
                                         ".mhd", ".vtk", ".tif"),
                         name_of_ending);

constexpr StoredType kAllTypes[] = {StoredType::kUInt8,  StoredType::kInt8,   StoredType::kUInt16,
                                    StoredType::kInt16,  StoredType::kUInt32, StoredType::kInt32,
                                    StoredType::kUInt64, StoredType::kInt64,  StoredType::kFloat32,
                                    StoredType::kFloat64};

TEST_P(EachFormat, KeepsGeometryAndVoxelsOfEachType) {
  for (const StoredType type : kAllTypes) {
    if (!has_type(type)) continue;
    SCOPED_TRACE(name_of(type));
    const Content written = content(type);
    write_with_itk(file(), written);
    const auto loaded = load_volume(file());
    ASSERT_TRUE(loaded.ok()) << loaded.failure().line();
    EXPECT_EQ(loaded->info.type, held_type(type));
    EXPECT_EQ(loaded->info.stored_type, name_of(type));
    const bool converted = name_of(held_type(type)) != std::string(name_of(type));
    EXPECT_EQ(loaded->info.notes.size(), (converted ? 1u : 0u) + (is_tiff() ? 1u : 0u));
    if (converted) {
      EXPECT_THAT(loaded->info.notes, Contains(HasSubstr("held as float32")));
    }
    if (is_tiff()) {
      EXPECT_EQ(loaded->info.geometry.size, written.geometry.size);
    } else {
      expect_geometry(loaded->info.geometry, written.geometry);
    }
    expect_voxels(*loaded, written);
  }
}

TEST_P(EachFormat, ProbingAndLoadingSayTheSame) {
  write_with_itk(file(), content(StoredType::kInt16));
  const auto probed = probe_volume(file());
  const auto loaded = load_volume(file());
  ASSERT_TRUE(probed.ok() && loaded.ok());
  EXPECT_EQ(probed->geometry, loaded->info.geometry);
  EXPECT_EQ(probed->type, loaded->info.type);
  EXPECT_EQ(probed->notes, loaded->info.notes);
  EXPECT_EQ(probed->format, loaded->info.format);
}

// Calls load_volume, which must keep silent.
Result<LoadedVolume> load_silently(const fs::path& file) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  auto loaded = load_volume(file);
  const std::string out = testing::internal::GetCapturedStdout();
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(out, "");
  return loaded;
}

// Wherever a file is cut: one line that names it, nothing on the terminal, no exception.
TEST_P(EachFormat, ATruncatedFileIsRefused) {
  write_with_itk(file(), content(StoredType::kUInt16));
  fs::path cut = file();  // or the file beside a detached header
  for (const auto& entry : fs::directory_iterator(folder_.path()))
    if (entry.path() != file()) cut = entry.path();
  const auto whole = bytes_of_file(cut);
  const std::size_t n = whole.size();
  for (const std::size_t length :
       {std::size_t(0), std::size_t(1), std::size_t(10), n / 4, n / 2, 3 * n / 4, n - 40, n - 1}) {
    SCOPED_TRACE(std::to_string(length) + " of " + std::to_string(n));
    write_bytes(cut, {whole.data(), length});
    const auto loaded = load_silently(file());
    if (is_tiff() && length == n - 1 && loaded.ok()) {  // the last byte is no voxel's
      expect_voxels(*loaded, content(StoredType::kUInt16));
      continue;
    }
    ASSERT_FALSE(loaded.ok());
    EXPECT_THAT(loaded.failure().line(), HasSubstr(file().filename().string()));
    EXPECT_THAT(loaded.failure().line(), Not(HasSubstr("\n")));
  }
}

TEST_P(EachFormat, ATruncatedHeaderIsRefused) {
  write_with_itk(file(), content(StoredType::kUInt16));
  const auto whole = bytes_of_file(file());
  for (const std::size_t length : {0, 1, 10, 50}) {
    write_bytes(file(), {whole.data(), length});
    EXPECT_FALSE(load_silently(file()).ok()) << length;
  }
}

// Bytes changed at random: a volume or a line, and never a crash or a word on the terminal.
TEST_P(EachFormat, ADamagedFileNeverCrashes) {
  write_with_itk(file(), content(StoredType::kInt16));
  const auto whole = bytes_of_file(file());
  std::uint32_t state = 12345;
  const auto random = [&] { return (state = state * 1664525u + 1013904223u) >> 8; };
  for (int round = 0; round < 300; ++round) {
    auto damaged = whole;
    for (int change = 0; change < 1 + round % 4; ++change)
      damaged[random() % std::min<std::size_t>(damaged.size(), 400)] = char(random());
    write_bytes(file(), damaged);
    const auto loaded = load_silently(file());
    if (loaded.ok()) {
      EXPECT_EQ(loaded->voxels().size(),
                loaded->info.geometry.voxel_count() * bytes_per_voxel(loaded->info.type));
    }
  }
}

class ComponentFormats : public EachFormat {};
INSTANTIATE_TEST_SUITE_P(Itk, ComponentFormats,
                         testing::Values(".nii", ".nii.gz", ".nrrd", ".mha", ".vtk", ".tif"),
                         name_of_ending);

TEST_P(ComponentFormats, TheChosenComponentIsHeldOrTheFirstWithANote) {
  const Content written = content(StoredType::kUInt8, 3);
  write_with_itk(file(), written);
  const auto first = load_volume(file());
  ASSERT_TRUE(first.ok()) << first.failure().line();
  EXPECT_EQ(first->info.components, 3);
  EXPECT_THAT(first->info.notes, Contains(HasSubstr("component 0 of 3")));
  expect_voxels(*first, written, 0);

  LoadOptions options;
  options.component = 2;
  const auto third = load_volume(file(), options);
  ASSERT_TRUE(third.ok());
  EXPECT_THAT(third->info.notes, Not(Contains(HasSubstr("component"))));
  expect_voxels(*third, written, 2);

  options.component = 3;
  const auto none = load_volume(file(), options);
  ASSERT_FALSE(none.ok());
  EXPECT_THAT(none.failure().line(), HasSubstr("no component 3"));
}

class TimeFormats : public EachFormat {};
INSTANTIATE_TEST_SUITE_P(Itk, TimeFormats, testing::Values(".nii", ".nii.gz", ".nrrd", ".mha"),
                         name_of_ending);

TEST_P(TimeFormats, TheFirstTimeStepIsShownWithANote) {
  const Content written = content(StoredType::kInt16, 1, 4);
  write_with_itk(file(), written);
  const auto loaded = load_volume(file());
  ASSERT_TRUE(loaded.ok()) << loaded.failure().line();
  EXPECT_THAT(loaded->info.notes, Contains(HasSubstr("first of 4 time steps")));
  expect_geometry(loaded->info.geometry, written.geometry);
  expect_voxels(*loaded, written);
}

TEST(VolumeFiles, WhatIsNotThereIsOneLine) {
  const auto loaded = load_volume("/nowhere/head.nii.gz");
  ASSERT_FALSE(loaded.ok());
  EXPECT_EQ(loaded.failure().line(),
            "goldthread: error: /nowhere/head.nii.gz: there is no such file (check the path)");
}

TEST(VolumeFiles, AnUnknownEndingNamesTheKnownOnes) {
  TemporaryFolder folder;
  write_text(folder / "notes.txt", "no volume");
  const auto loaded = load_volume(folder / "notes.txt");
  ASSERT_FALSE(loaded.ok());
  EXPECT_THAT(loaded.failure().line(), HasSubstr(".nii.gz"));
}

TEST(VolumeFiles, AnotherFormatBehindTheEndingIsRefused) {
  TemporaryFolder folder;
  for (const char* ending :
       {".nii", ".nii.gz", ".hdr", ".nrrd", ".nhdr", ".mha", ".mhd", ".vtk", ".tif", ".vdb"}) {
    const fs::path file = folder / ("page" + std::string(ending));
    write_text(file,
               "<html><body>404: there is no such volume</body></html>\n" + std::string(1000, '.'));
    const auto loaded = load_silently(file);
    EXPECT_FALSE(loaded.ok()) << ending;
  }
}

// Hostile MetaImage headers: plain text, so that each says what is wrong with it.
class HostileHeader : public testing::TestWithParam<std::pair<const char*, const char*>> {};
INSTANTIATE_TEST_SUITE_P(
    MetaImage, HostileHeader,
    testing::Values(std::pair("DimSize = 1000000 1000000 1000000", "promises|2^40"),
                    std::pair("DimSize = 4294967297 1 1", "size|promises|edge"),
                    std::pair("DimSize = 2147483647 2147483647 2147483647", "size|edge"),
                    std::pair("DimSize = 4000 4000 4000", "promises"),
                    std::pair("DimSize = 0 2 2", "size"),
                    std::pair("DimSize = -2 2 2", "size|edge"),
                    std::pair("ElementSpacing = 1 nan 1", "spacing|not readable"),
                    std::pair("ElementSpacing = 1 0 1", "spacing"),
                    std::pair("ElementSpacing = 1 -1 1", "spacing"),
                    std::pair("ElementSpacing = 1 inf 1", "spacing|not readable"),
                    std::pair("Offset = 0 nan 0", "origin|not readable"),
                    std::pair("TransformMatrix = 1 0 0 1 0 0 0 0 1", "singular"),
                    std::pair("TransformMatrix = 0 0 0 0 0 0 0 0 0", "singular"),
                    std::pair("TransformMatrix = nan 0 0 0 1 0 0 0 1", "singular|not readable"),
                    std::pair("ElementNumberOfChannels = 1000000", "components"),
                    std::pair("ElementNumberOfChannels = -1", "components"),
                    std::pair("NDims = 200", "")));

TEST_P(HostileHeader, IsRefusedWithItsReason) {
  TemporaryFolder folder;
  const fs::path file = folder / "hostile.mha";
  const auto [line, reason] = GetParam();
  const std::string key = std::string(line).substr(0, std::string(line).find(' '));
  std::string text;
  for (const std::string given :
       {"ObjectType = Image", "NDims = 3", "BinaryData = True", "BinaryDataByteOrderMSB = False",
        "TransformMatrix = 1 0 0 0 1 0 0 0 1", "Offset = 0 0 0", "ElementSpacing = 1 1 1",
        "DimSize = 2 2 2", "ElementNumberOfChannels = 1", "ElementType = MET_UCHAR"})
    text += (given.starts_with(key + " ") ? std::string(line) : given) + "\n";
  write_text(file, text + "ElementDataFile = LOCAL\n01234567");
  const auto loaded = load_silently(file);
  ASSERT_FALSE(loaded.ok());
  bool named = false;
  for (std::size_t at = 0; at <= std::string(reason).size();) {
    const std::size_t end = std::min(std::string(reason).find('|', at), std::string(reason).size());
    named |=
        loaded.failure().line().find(std::string(reason).substr(at, end - at)) != std::string::npos;
    at = end + 1;
  }
  EXPECT_TRUE(named) << loaded.failure().line();
}

}  // namespace
}  // namespace goldthread
