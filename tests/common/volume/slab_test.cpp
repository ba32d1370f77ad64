// SPDX-License-Identifier: Apache-2.0
// Volumes cut into slabs: what each holds, and that together they are the whole.

#include "common/volume/slab.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "common/volume/build_volume.h"
#include "common/volume/slab_statistics.h"

namespace goldthread {
namespace {

template <class T>
class Slabs : public testing::Test {};
using VoxelTypes = testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, float>;
TYPED_TEST_SUITE(Slabs, VoxelTypes);

template <class T>
constexpr VoxelType type_of() {
  if constexpr (std::is_same_v<T, std::uint8_t>) return VoxelType::kUInt8;
  if constexpr (std::is_same_v<T, std::int8_t>) return VoxelType::kInt8;
  if constexpr (std::is_same_v<T, std::uint16_t>) return VoxelType::kUInt16;
  if constexpr (std::is_same_v<T, std::int16_t>) return VoxelType::kInt16;
  return VoxelType::kFloat32;
}

template <class T>
std::vector<T> noise(glm::ivec3 size) {
  std::mt19937 random(7);
  std::vector<T> voxels(std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z));
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    voxels[i] = T(int(random() % 60000) - 30000);
    if constexpr (std::is_floating_point_v<T>)
      if (i % 37 == 0) voxels[i] = std::numeric_limits<T>::quiet_NaN();
  }
  return voxels;
}

template <class T>
VolumeInfo info_of(glm::ivec3 size) {
  VolumeInfo info;
  info.type = type_of<T>();
  info.geometry.size = size;
  return info;
}

struct Block {
  explicit Block(std::size_t bytes)
      : memory(static_cast<std::byte*>(::operator new(bytes, std::align_val_t(kBlockAlignment))),
               [](std::byte* p) { ::operator delete(p, std::align_val_t(kBlockAlignment)); }),
        size(bytes) {
    std::memset(memory.get(), 0xAB, bytes);
  }
  std::shared_ptr<std::byte> memory;
  std::size_t size;
};

/// Slab `index` of `count`, read by slices.
template <class T>
std::shared_ptr<const Volume> slab_of_noise(const std::vector<T>& linear, glm::ivec3 size,
                                            int index, int count, VolumeInfo& info) {
  info = info_of<T>(size);
  const Slab slab = slab_of(size.z, index, count);
  const Block block(Volume::block_bytes(info.geometry, info.type, slab));
  const std::size_t slice = std::size_t(size.x) * std::size_t(size.y) * sizeof(T);
  const auto failure = fill_slab(
      info, slab,
      [&](int first, int slices, std::span<std::byte> to) -> std::optional<Failure> {
        EXPECT_EQ(to.size(), slice * std::size_t(slices));
        std::memcpy(to.data(),
                    reinterpret_cast<const std::byte*>(linear.data()) + slice * std::size_t(first),
                    to.size());
        return std::nullopt;
      },
      {block.memory.get(), block.size});
  EXPECT_FALSE(failure);
  return std::make_shared<const Volume>(info, slab, block.memory);
}

const std::vector<glm::ivec3> kSizes = {{7, 9, 16}, {20, 3, 17}, {5, 33, 40}, {12, 12, 61}};

TEST(Slab, SlabsCoverAllLayersOnceAndAreEven) {
  for (int slices = 1; slices < 200; ++slices)
    for (int count = 1; count <= layers_of(slices); ++count) {
      int next = 0;
      for (int i = 0; i < count; ++i) {
        const Slab slab = slab_of(slices, i, count);
        EXPECT_EQ(slab.first_layer, next);
        const int layers = slab.last_layer - slab.first_layer;
        EXPECT_GE(layers, layers_of(slices) / count);
        EXPECT_LE(layers, layers_of(slices) / count + 1);
        next = slab.last_layer;
      }
      EXPECT_EQ(next, layers_of(slices));
    }
}

TYPED_TEST(Slabs, HoldTheVoxelsOfTheWholeAndTwoSlicesBeyond) {
  for (const glm::ivec3 size : kSizes) {
    const auto linear = noise<TypeParam>(size);
    const auto whole = build_volume(info_of<TypeParam>(size), std::as_bytes(std::span(linear)));
    for (int count = 1; count <= layers_of(size.z); ++count)
      for (int i = 0; i < count; ++i) {
        VolumeInfo info;
        const auto part = slab_of_noise(linear, size, i, count, info);
        const LayerRange own = own_slices(part->slab(), size.z);
        std::size_t wrong = 0;
        for (int z = std::max(own.first - 2, 0); z < std::min(own.last + 3, size.z); ++z)
          for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x) {
              const double a = part->at(x, y, z), b = whole->at(x, y, z);
              wrong += !(a == b || (std::isnan(a) && std::isnan(b)));
            }
        EXPECT_EQ(wrong, 0U) << size.z << " slices, slab " << i << " of " << count;
      }
  }
}

TYPED_TEST(Slabs, KnowTheirOwnCellsAndThatTheOthersMayHoldAnything) {
  for (const glm::ivec3 size : kSizes) {
    const auto linear = noise<TypeParam>(size);
    const auto whole = build_volume(info_of<TypeParam>(size), std::as_bytes(std::span(linear)));
    const int count = layers_of(size.z);
    const glm::ivec3 cells = whole->cell_counts();
    const std::size_t in_layer = std::size_t(cells.x) * std::size_t(cells.y);
    for (int i = 0; i < count; ++i) {
      VolumeInfo info;
      const auto part = slab_of_noise(linear, size, i, count, info);
      const LayerRange layers = part->layers();
      ASSERT_EQ(part->cells().size(), in_layer * std::size_t(layers.count()));
      for (int layer = layers.first; layer < layers.last; ++layer)
        for (std::size_t cell = 0; cell < in_layer; ++cell) {
          const CellRange known =
              part->cells()[std::size_t(layer - layers.first) * in_layer + cell];
          const CellRange expected = whole->cells()[std::size_t(layer) * in_layer + cell];
          if (layer == i) {
            EXPECT_EQ(known.minimum, expected.minimum);
            EXPECT_EQ(known.maximum, expected.maximum);
          } else {
            EXPECT_TRUE(std::isinf(known.minimum) && known.minimum < 0);
            EXPECT_TRUE(std::isinf(known.maximum) && known.maximum > 0);
          }
        }
    }
  }
}

TYPED_TEST(Slabs, StatisticsOfAllAreThoseOfTheWhole) {
  for (const glm::ivec3 size : kSizes) {
    const auto linear = noise<TypeParam>(size);
    const VolumeInfo expected =
        build_volume(info_of<TypeParam>(size), std::as_bytes(std::span(linear)))->info();
    for (int count = 1; count <= layers_of(size.z); ++count) {
      VolumeInfo merged = info_of<TypeParam>(size);
      std::vector<SlabStatistics> parts;
      std::vector<std::shared_ptr<const Volume>> slabs;
      for (int i = 0; i < count; ++i) {
        VolumeInfo info;
        slabs.push_back(slab_of_noise(linear, size, i, count, info));
        parts.push_back(statistics_of(info, slabs.back()->slab()));
      }
      merge_statistics(parts, merged);
      for (const auto& slab : slabs)
        add_counts(count_voxels(*slab, merged.minimum, merged.maximum), merged.histogram);
      EXPECT_EQ(merged.minimum, expected.minimum);
      EXPECT_EQ(merged.maximum, expected.maximum);
      EXPECT_EQ(merged.not_finite, expected.not_finite);
      EXPECT_EQ(merged.histogram, expected.histogram);
    }
  }
}

TEST(Slab, ASlabWithoutAFiniteVoxelDoesNotCount) {
  VolumeInfo whole;
  const SlabStatistics parts[] = {{100, 100, 0, 0}, {100, 3, 5, 9}, {100, 0, 7, 11}};
  merge_statistics(parts, whole);
  EXPECT_EQ(whole.minimum, 5);
  EXPECT_EQ(whole.maximum, 11);
  EXPECT_EQ(whole.not_finite, 103U);
  merge_statistics(std::span(parts).first(1), whole);
  EXPECT_EQ(whole.minimum, 0);
  EXPECT_EQ(whole.maximum, 0);
}

TEST(Slab, ASlabOfALargeVolumeTakesLittleMoreThanItsShare) {
  const VolumeGeometry geometry{.size = {1626, 1626, 1626}};
  for (const int count : {2, 4, 8}) {
    for (int i = 0; i < count; ++i) {
      const double bytes = double(
          Volume::block_bytes(geometry, VoxelType::kUInt8, slab_of(geometry.size.z, i, count)));
      EXPECT_LT(bytes, 1.15 * double(geometry.voxel_count()) / count) << count;
    }
  }
}

TEST(Slab, AFailureOfTheReaderIsTold) {
  VolumeInfo info = info_of<std::uint8_t>({4, 4, 20});
  const Slab slab = slab_of(20, 1, 2);
  const Block block(Volume::block_bytes(info.geometry, info.type, slab));
  const auto failure =
      fill_slab(info, slab,
                [](int, int, std::span<std::byte>) {
                  return std::optional(Failure{"f", "stopped", "mend", ExitStatus::kBadInput});
                },
                {block.memory.get(), block.size});
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->what, "stopped");
}

}  // namespace
}  // namespace goldthread
