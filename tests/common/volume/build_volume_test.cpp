// SPDX-License-Identifier: Apache-2.0
#include "common/volume/build_volume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>

namespace goldthread {
namespace {

template <class T>
constexpr VoxelType kTypeOf = VoxelType::kFloat32;
template <>
constexpr VoxelType kTypeOf<std::uint8_t> = VoxelType::kUInt8;
template <>
constexpr VoxelType kTypeOf<std::int8_t> = VoxelType::kInt8;
template <>
constexpr VoxelType kTypeOf<std::uint16_t> = VoxelType::kUInt16;
template <>
constexpr VoxelType kTypeOf<std::int16_t> = VoxelType::kInt16;

// Voxels over the whole range of T; every tenth float or so is not finite.
template <class T>
std::vector<T> noise(glm::ivec3 size) {
  std::mt19937 random(unsigned(size.x * 10007 + size.y * 101 + size.z));
  std::vector<T> voxels(std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z));
  for (T& voxel : voxels) {
    if constexpr (std::is_floating_point_v<T>) {
      voxel = std::uniform_real_distribution<T>(-1000, 1000)(random);
      const auto fate = random() % 30;
      if (fate == 0) voxel = std::numeric_limits<T>::quiet_NaN();
      if (fate == 1) voxel = std::numeric_limits<T>::infinity();
      if (fate == 2) voxel = -std::numeric_limits<T>::infinity();
    } else {
      voxel = T(random());
    }
  }
  return voxels;
}

template <class T>
std::shared_ptr<const Volume> volume_of(const std::vector<T>& voxels, glm::ivec3 size) {
  VolumeInfo info;
  info.type = kTypeOf<T>;
  info.geometry.size = size;
  return build_volume(info, std::as_bytes(std::span(voxels)));
}

template <class T>
class Columns : public testing::Test {};
using AllTypes = testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, float>;
TYPED_TEST_SUITE(Columns, AllTypes);

constexpr int kEdges[] = {1, 7, 8, 9, 31, 32, 33, 70};

// Each edge along each axis, the other two axes being of another one.
std::vector<glm::ivec3> sizes() {
  std::vector<glm::ivec3> all;
  for (const int edge : kEdges) {
    all.insert(all.end(), {{edge, 9, 7}, {33, edge, 9}, {31, 8, edge}, {edge, edge, edge}});
  }
  return all;
}

// Calls check(i, j, k, index in linear order) for each voxel.
template <class Check>
void for_each_voxel(glm::ivec3 size, Check check) {
  std::size_t index = 0;
  for (int k = 0; k < size.z; ++k)
    for (int j = 0; j < size.y; ++j)
      for (int i = 0; i < size.x; ++i) check(i, j, k, index++);
}

TYPED_TEST(Columns, HoldEachVoxelsValue) {
  for (const glm::ivec3 size : sizes()) {
    const auto linear = noise<TypeParam>(size);
    const auto volume = volume_of(linear, size);
    std::size_t wrong = 0;
    for_each_voxel(size, [&](int i, int j, int k, std::size_t index) {
      const double expected = double(linear[index]);
      const double found = volume->at(i, j, k);
      wrong += std::isfinite(expected) ? found != expected : !std::isnan(found);
    });
    EXPECT_EQ(wrong, 0u) << size.x << " " << size.y << " " << size.z;
  }
}

// The promise to kernels: 8 slices of a window follow each other, 4×4 bytes each, plane by plane,
// and one voxel beyond the volume its border is repeated.
TYPED_TEST(Columns, AreSlicesOfSixteenWithTheBorderRepeated) {
  constexpr int kApron = ColumnLayout::kApron;
  for (const glm::ivec3 size : sizes()) {
    const auto volume = volume_of(noise<TypeParam>(size), size);
    const ColumnLayout& layout = volume->layout();
    ASSERT_EQ(layout.planes, int(sizeof(TypeParam)));
    std::size_t wrong = 0;
    for_each_voxel(size + 2 * kApron, [&](int x, int y, int z, std::size_t) {
      const glm::ivec3 inside = glm::clamp(glm::ivec3(x, y, z) - kApron, glm::ivec3(0), size - 1);
      const glm::ivec3 stored = inside + kApron;
      for (int plane = 0; plane < layout.planes; ++plane) {
        const std::int64_t column = (y / 4) * layout.row_bytes() + (x / 4) * layout.column_bytes() +
                                    plane * layout.plane_bytes;
        wrong += volume->voxels()[column + 16 * z + 4 * (y % 4) + x % 4] !=
                 volume->voxels()[layout.offset(stored.x, stored.y, stored.z) +
                                  plane * layout.plane_bytes];
      }
    });
    EXPECT_EQ(wrong, 0u) << size.x << " " << size.y << " " << size.z;
  }
}

TYPED_TEST(Columns, HoldAWindowAnywhereAndAreNotMuchLargerThanTheVoxels) {
  for (const glm::ivec3 size : sizes()) {
    const ColumnLayout layout(size, int(sizeof(TypeParam)));
    EXPECT_GE(layout.slices, ColumnLayout::kWindow);
    EXPECT_GE(layout.columns.x, 2);
    EXPECT_GE(layout.columns.y, 2);
    EXPECT_GE(layout.plane_bytes, layout.slices * ColumnLayout::kSlice);
    EXPECT_EQ(layout.plane_bytes % 128, 64);
  }
  const ColumnLayout large({512, 512, 512}, int(sizeof(TypeParam)));
  EXPECT_LT(double(large.byte_count()), 1.03 * double(sizeof(TypeParam)) * (1 << 27));
}

TYPED_TEST(Columns, CellsKnowTheRangeOfTheVoxelsThatASampleInsideTouches) {
  for (const glm::ivec3 size : sizes()) {
    const auto linear = noise<TypeParam>(size);
    const auto volume = volume_of(linear, size);
    const glm::ivec3 counts = volume->cell_counts();
    ASSERT_EQ(counts, (size + 7) / 8);
    std::size_t wrong = 0;
    for_each_voxel(counts, [&](int cx, int cy, int cz, std::size_t cell) {
      double least = std::numeric_limits<double>::infinity();
      double greatest = -least;
      const glm::ivec3 first = glm::ivec3(cx, cy, cz) * 8;
      const glm::ivec3 last = glm::min(first + 8, size - 1);
      for (int k = first.z; k <= last.z; ++k)
        for (int j = first.y; j <= last.y; ++j)
          for (int i = first.x; i <= last.x; ++i) {
            const double value = double(linear[(std::size_t(k) * size.y + j) * size.x + i]);
            if (!std::isfinite(value)) continue;
            least = std::min(least, value);
            greatest = std::max(greatest, value);
          }
      const CellRange range = volume->cells()[cell];
      wrong += double(range.minimum) + volume->value_bias() != least;
      wrong += double(range.maximum) + volume->value_bias() != greatest;
    });
    EXPECT_EQ(wrong, 0u) << size.x << " " << size.y << " " << size.z;
  }
}

TYPED_TEST(Columns, StatisticsAgreeWithTheVoxels) {
  for (const glm::ivec3 size : sizes()) {
    const auto linear = noise<TypeParam>(size);
    const VolumeInfo info = volume_of(linear, size)->info();
    double least = std::numeric_limits<double>::infinity();
    double greatest = -least;
    std::uint64_t finite = 0;
    for (const TypeParam voxel : linear) {
      if (!std::isfinite(double(voxel))) continue;
      ++finite;
      least = std::min(least, double(voxel));
      greatest = std::max(greatest, double(voxel));
    }
    if (finite == 0) least = greatest = 0;
    EXPECT_EQ(info.minimum, least);
    EXPECT_EQ(info.maximum, greatest);
    EXPECT_EQ(info.not_finite, linear.size() - finite);
    std::vector<std::uint64_t> bins(256);
    for (const TypeParam voxel : linear)
      if (std::isfinite(double(voxel)))
        ++bins[greatest > least
                   ? std::min<std::size_t>(
                         255, std::size_t((double(voxel) - least) * (256 / (greatest - least))))
                   : 0];
    EXPECT_EQ(info.histogram, bins);
    EXPECT_EQ(std::accumulate(info.histogram.begin(), info.histogram.end(), std::uint64_t(0)),
              finite);
  }
}

TEST(BuildVolume, AVolumeWithoutAFiniteVoxelIsEmpty) {
  const std::vector<float> voxels(8, std::numeric_limits<float>::quiet_NaN());
  const auto volume = volume_of(voxels, {2, 2, 2});
  EXPECT_EQ(volume->info().minimum, 0);
  EXPECT_EQ(volume->info().maximum, 0);
  EXPECT_EQ(volume->info().not_finite, 8u);
  EXPECT_GT(volume->cells()[0].minimum, volume->cells()[0].maximum);
  EXPECT_EQ(volume->info().histogram, std::vector<std::uint64_t>(256));
}

TEST(BuildVolume, AConstantVolumeIsInOneBin) {
  const std::vector<std::int16_t> voxels(27, -1000);
  const VolumeInfo info = volume_of(voxels, {3, 3, 3})->info();
  EXPECT_EQ(info.minimum, -1000);
  EXPECT_EQ(info.maximum, -1000);
  EXPECT_EQ(info.histogram[0], 27u);
}

TEST(BuildVolume, FillsMemoryThatTheCallerOwns) {
  const glm::ivec3 size(40, 10, 10);
  const auto linear = noise<std::uint16_t>(size);
  VolumeInfo info;
  info.type = VoxelType::kUInt16;
  info.geometry.size = size;
  const std::size_t bytes = Volume::block_bytes(info.geometry, info.type);
  ASSERT_EQ(bytes % kBlockAlignment, 0u);
  struct alignas(64) Line {
    std::byte bytes[64];
  };
  std::vector<Line> lines(bytes / 64 + 1, Line{});
  std::memset(lines.back().bytes, 0x5A, 64);
  auto* block = lines[0].bytes;
  fill_block(info, std::as_bytes(std::span(linear)), {block, bytes});
  const Volume volume(info, std::shared_ptr<const std::byte>(std::shared_ptr<void>{}, block));
  EXPECT_EQ(volume.at(39, 9, 9), linear.back());
  for (const std::byte guard : lines.back().bytes) EXPECT_EQ(guard, std::byte{0x5A});
}

TEST(VolumeGeometry, MapsAreInverseOfEachOtherFarFromTheOrigin) {
  VolumeGeometry geometry;
  geometry.spacing_mm = {0.5, 1, 1000};
  geometry.origin_mm = {1e7, -1e7, 3};
  geometry.direction = glm::dmat3({0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, -1});
  const glm::dvec4 world = geometry.world_from_index() * glm::dvec4(10, 20, 30, 1);
  EXPECT_DOUBLE_EQ(world.x, 1e7 + 0.6 * 5 - 0.8 * 20);
  EXPECT_DOUBLE_EQ(world.y, -1e7 + 0.8 * 5 + 0.6 * 20);
  EXPECT_DOUBLE_EQ(world.z, 3 - 30000);
  const glm::dvec4 index = geometry.index_from_world() * world;
  EXPECT_NEAR(index.x, 10, 1e-7);
  EXPECT_NEAR(index.y, 20, 1e-7);
  EXPECT_NEAR(index.z, 30, 1e-7);
}

}  // namespace
}  // namespace goldthread
