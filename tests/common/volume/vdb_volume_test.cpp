// SPDX-License-Identifier: Apache-2.0
// OpenVDB files: an oblique grid with holes, several grids, what is refused, and damage.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <cstring>

#include "common/volume/volume_io.h"
#include "tests/common/volume/volume_writers.h"

namespace goldthread {
namespace {

using testing::Contains;
using testing::HasSubstr;
using namespace testing_files;
namespace fs = std::filesystem;

// A grid of background −1 with three active voxels, turned and stretched.
template <class Grid>
typename Grid::Ptr sparse_grid(const std::string& name) {
  openvdb::initialize();
  auto grid = Grid::create(typename Grid::ValueType(-1));
  grid->setName(name);
  auto access = grid->getAccessor();
  access.setValue({-2, 3, 10}, typename Grid::ValueType(5));
  access.setValue({1, 3, 10}, typename Grid::ValueType(6));
  access.setValue({0, 7, 12}, typename Grid::ValueType(7));
  // Rows are the ways of the index axes.
  grid->setTransform(openvdb::math::Transform::createLinearTransform(openvdb::Mat4d(
      0.3, 0.4, 0.0, 0.0, -1.6, 1.2, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 100.0, 200.0, 300.0, 1.0)));
  return grid;
}

void write_vdb(const fs::path& file, const openvdb::GridPtrVec& grids) {
  openvdb::io::File(file.string()).write(grids);
}

float value_at(const LoadedVolume& loaded, std::size_t index) {
  float value;
  std::memcpy(&value, loaded.voxels().data() + index * sizeof value, sizeof value);
  return value;
}

template <class Grid>
class VdbGrid : public testing::Test {};
using Grids = testing::Types<openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid>;
TYPED_TEST_SUITE(VdbGrid, Grids);

TYPED_TEST(VdbGrid, FillsTheBoxOfItsActiveVoxelsWithBackground) {
  TemporaryFolder folder;
  write_vdb(folder / "smoke.vdb", {sparse_grid<TypeParam>("density")});
  const auto loaded = load_volume(folder / "smoke.vdb");
  ASSERT_TRUE(loaded.ok()) << loaded.failure().line();
  const VolumeGeometry& geometry = loaded->info.geometry;
  ASSERT_EQ(geometry.size, glm::ivec3(4, 5, 3));
  EXPECT_NEAR(glm::length(geometry.spacing_mm - glm::dvec3(0.5, 2, 3)), 0, 1e-12);
  EXPECT_NEAR(glm::length(geometry.direction[0] - glm::dvec3(0.6, 0.8, 0)), 0, 1e-12);
  EXPECT_NEAR(glm::length(geometry.direction[1] - glm::dvec3(-0.8, 0.6, 0)), 0, 1e-12);
  const glm::dvec3 origin(100 - 0.6 - 4.8, 200 - 0.8 + 3.6, 330);  // of index (−2, 3, 10)
  EXPECT_NEAR(glm::length(geometry.origin_mm - origin), 0, 1e-9);
  for (std::size_t i = 0; i < 60; ++i)
    EXPECT_EQ(value_at(*loaded, i), i == 0                     ? 5
                                    : i == 3                   ? 6
                                    : i == 2 + 4 * (4 + 5 * 2) ? 7
                                                               : -1)
        << i;
}

TEST(VdbVolume, AGridIsFoundByItsName) {
  TemporaryFolder folder;
  const fs::path file = folder / "two.vdb";
  auto second = sparse_grid<openvdb::FloatGrid>("heat");
  second->getAccessor().setValue({1, 3, 10}, 42);
  write_vdb(file,
            {openvdb::Vec3SGrid::create(), sparse_grid<openvdb::FloatGrid>("density"), second});
  const auto first = load_volume(file);
  ASSERT_TRUE(first.ok()) << first.failure().line();
  EXPECT_EQ(value_at(*first, 3), 6);
  EXPECT_THAT(first->info.notes, Contains(HasSubstr("heat")));
  LoadOptions options;
  options.grid = "heat";
  const auto named = load_volume(file, options);
  ASSERT_TRUE(named.ok());
  EXPECT_EQ(value_at(*named, 3), 42);
  options.grid = "absent";
  EXPECT_FALSE(load_volume(file, options).ok());
}

TEST(VdbVolume, AFrustumAndAnEmptyGridAreRefused) {
  TemporaryFolder folder;
  auto frustum = sparse_grid<openvdb::FloatGrid>("density");
  frustum->setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd({0, 0, 0}, {10, 10, 10}), 0.5, 10, 1));
  write_vdb(folder / "frustum.vdb", {frustum});
  const auto refused = load_volume(folder / "frustum.vdb");
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.failure().what, HasSubstr("frustum"));
  write_vdb(folder / "empty.vdb", {openvdb::FloatGrid::create()});
  EXPECT_FALSE(load_volume(folder / "empty.vdb").ok());
}

TEST(VdbVolume, ABoxLargerThanMemoryIsRefused) {
  TemporaryFolder folder;
  auto grid = sparse_grid<openvdb::FloatGrid>("density");
  grid->getAccessor().setValue({100000, 100000, 100000}, 1);
  write_vdb(folder / "far.vdb", {grid});
  EXPECT_FALSE(load_volume(folder / "far.vdb").ok());
}

TEST(VdbVolume, ATruncatedFileIsRefused) {
  TemporaryFolder folder;
  const fs::path file = folder / "cut.vdb";
  write_vdb(file, {sparse_grid<openvdb::FloatGrid>("density")});
  const auto whole = bytes_of_file(file);
  const std::size_t n = whole.size();
  for (const std::size_t length : {std::size_t(0), std::size_t(1), std::size_t(10), std::size_t(60),
                                   n / 4, n / 2, 3 * n / 4, n - 40, n - 1}) {
    SCOPED_TRACE(std::to_string(length) + " of " + std::to_string(n));
    write_bytes(file, {whole.data(), length});
    testing::internal::CaptureStderr();
    const auto loaded = load_volume(file);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_FALSE(loaded.ok());
  }
}

}  // namespace
}  // namespace goldthread
