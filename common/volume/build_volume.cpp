// SPDX-License-Identifier: Apache-2.0
#include "common/volume/build_volume.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <type_traits>
#include <vector>

#include "common/base/result.h"

namespace goldthread {
namespace {

constexpr std::size_t kBins = 256;

// How a type of the file is stored: signed integers with their sign bit flipped, floats as they
// are.
template <class T>
using Stored = std::conditional_t<
    std::is_floating_point_v<T>, T,
    std::make_unsigned_t<std::conditional_t<std::is_floating_point_v<T>, int, T>>>;

template <class T>
Stored<T> stored_from(T value) {
  if constexpr (std::is_floating_point_v<T>) {
    return std::isfinite(value) ? value : std::numeric_limits<T>::quiet_NaN();
  } else if constexpr (std::is_signed_v<T>) {
    constexpr auto kSignBit = Stored<T>(Stored<T>(1) << (8 * sizeof(T) - 1));
    return Stored<T>(Stored<T>(value) ^ kSignBit);
  } else {
    return value;
  }
}

// What one thread counts. Integers are counted by value and binned once the range is known.
struct Tally {
  std::vector<std::uint64_t> counts;
  std::uint64_t not_finite = 0;
  double minimum = std::numeric_limits<double>::infinity();
  double maximum = -std::numeric_limits<double>::infinity();
};

// Equal bins over [minimum, maximum]; the maximum belongs to the last.
class Binning {
 public:
  Binning(double minimum, double maximum)
      : minimum_(minimum), scale_(maximum > minimum ? kBins / (maximum - minimum) : 0) {}
  std::size_t operator()(double value) const {
    return std::min(kBins - 1, std::size_t((value - minimum_) * scale_));
  }

 private:
  double minimum_, scale_;
};

// One volume of one type on its way into its block.
template <class T>
class BlockFiller {
 public:
  using S = Stored<T>;

  BlockFiller(const VolumeGeometry& geometry, VoxelType type, const std::byte* linear,
              std::byte* block)
      : size_(geometry.size),
        layout_(geometry.size),
        cell_counts_(Volume::cell_counts(geometry)),
        linear_(reinterpret_cast<const T*>(linear)),
        voxels_(reinterpret_cast<S*>(block)),
        cells_(reinterpret_cast<CellRange*>(block + Volume::cells_offset(geometry, type))) {
    const std::size_t used = std::size_t(layout_.element_count()) * sizeof(S);
    std::memset(block + used, 0, Volume::cells_offset(geometry, type) - used);
  }

  void run(VolumeInfo& info) {
    const int rows = layout_.bricks.y * layout_.bricks.z;
    tbb::parallel_for(tbb::blocked_range<int>(0, rows), [&](const tbb::blocked_range<int>& range) {
      Tally& tally = tallies_.local();
      tally.counts.resize(kCountedValues);
      RowBuffers buffers(size_.x);
      for (int row = range.begin(); row < range.end(); ++row)
        fill_row_of_bricks(row % layout_.bricks.y, row / layout_.bricks.y, buffers, tally);
    });
    finish(info);
  }

 private:
  static constexpr std::size_t kCountedValues =
      std::is_floating_point_v<T> ? 0 : std::size_t(1) << (8 * std::min<std::size_t>(sizeof(T), 2));

  // Working memory of one row of bricks: one row of voxels, and the least and greatest at each x.
  struct RowBuffers {
    explicit RowBuffers(int width)
        : row(std::size_t(width)), least(std::size_t(width)), greatest(std::size_t(width)) {}
    std::vector<S> row, least, greatest;
  };

  static constexpr S kLeast = std::numeric_limits<S>::has_infinity
                                  ? -std::numeric_limits<S>::infinity()
                                  : std::numeric_limits<S>::lowest();
  static constexpr S kGreatest = std::numeric_limits<S>::has_infinity
                                     ? std::numeric_limits<S>::infinity()
                                     : std::numeric_limits<S>::max();

  // Bricks (·, by, bz) and their cells. Reads 9×9 rows: a cell ends on its upper neighbours'
  // voxels.
  void fill_row_of_bricks(int by, int bz, RowBuffers& buffers, Tally& tally) {
    std::fill(buffers.least.begin(), buffers.least.end(), kGreatest);
    std::fill(buffers.greatest.begin(), buffers.greatest.end(), kLeast);
    for (int z = 0; z <= kCellEdge; ++z) {
      for (int y = 0; y <= kCellEdge; ++y) {
        const bool inside_brick = y < kCellEdge && z < kCellEdge;
        const glm::ivec2 wanted(by * kCellEdge + y, bz * kCellEdge + z);
        const glm::ivec2 at = glm::min(wanted, glm::ivec2(size_.y, size_.z) - 1);
        if (at != wanted && !inside_brick) continue;
        read_row(at.x, at.y, buffers);
        if (inside_brick) {
          write_row(y, z, by, bz, buffers.row);
          if (at == wanted) count_row(buffers.row, tally);
        }
      }
    }
    write_cells(by, bz, buffers, tally);
  }

  void read_row(int y, int z, RowBuffers& buffers) const {
    const T* from =
        linear_ + (std::size_t(z) * std::size_t(size_.y) + std::size_t(y)) * std::size_t(size_.x);
    const auto width = std::size_t(size_.x);
    S* row = buffers.row.data();
    S* least = buffers.least.data();
    S* greatest = buffers.greatest.data();
    for (std::size_t x = 0; x < width; ++x) {
      const S value = stored_from(from[x]);
      row[x] = value;
      // In this order a NaN compares false and is left out.
      least[x] = value < least[x] ? value : least[x];
      greatest[x] = value > greatest[x] ? value : greatest[x];
    }
  }

  void write_row(int y, int z, int by, int bz, const std::vector<S>& row) {
    const std::int64_t first_brick = (std::int64_t(bz) * layout_.bricks.y + by) * layout_.bricks.x;
    for (int bx = 0; bx < layout_.bricks.x; ++bx) {
      S* to = voxels_ + (first_brick + bx) * BrickLayout::kBrick + z * BrickLayout::kSlice +
              y * BrickLayout::kRow;
      const int first = bx * BrickLayout::kEdgeX - BrickLayout::kLeft;
      const int from = std::max(first, 0);
      const int end = std::min(first + BrickLayout::kRow, size_.x);
      std::fill(to, to + (from - first), row.front());
      std::copy(row.data() + from, row.data() + end, to + (from - first));
      std::fill(to + (end - first), to + BrickLayout::kRow, row.back());
    }
  }

  void count_row(const std::vector<S>& row, Tally& tally) const {
    if constexpr (std::is_floating_point_v<T>) {
      std::uint64_t not_finite = 0;
      for (const S value : row) not_finite += std::isfinite(value) ? 0 : 1;
      tally.not_finite += not_finite;
    } else {
      for (const S value : row) ++tally.counts[value];
    }
  }

  void write_cells(int by, int bz, const RowBuffers& buffers, Tally& tally) {
    const std::int64_t first = (std::int64_t(bz) * cell_counts_.y + by) * cell_counts_.x;
    for (int cx = 0; cx < cell_counts_.x; ++cx) {
      const int end = std::min((cx + 1) * kCellEdge + 1, size_.x);
      CellRange range{std::numeric_limits<float>::infinity(),
                      -std::numeric_limits<float>::infinity()};
      for (int x = cx * kCellEdge; x < end; ++x) {
        range.minimum = std::min(range.minimum, float(buffers.least[std::size_t(x)]));
        range.maximum = std::max(range.maximum, float(buffers.greatest[std::size_t(x)]));
      }
      cells_[first + cx] = range;
      tally.minimum = std::min(tally.minimum, double(range.minimum));
      tally.maximum = std::max(tally.maximum, double(range.maximum));
    }
  }

  void finish(VolumeInfo& info) {
    Tally total;
    total.counts.resize(kCountedValues);
    for (const Tally& tally : tallies_) {
      total.not_finite += tally.not_finite;
      total.minimum = std::min(total.minimum, tally.minimum);
      total.maximum = std::max(total.maximum, tally.maximum);
      for (std::size_t i = 0; i < tally.counts.size(); ++i) total.counts[i] += tally.counts[i];
    }
    info.not_finite = total.not_finite;
    info.histogram.assign(kBins, 0);
    const bool any = total.minimum <= total.maximum;
    const Binning bin(any ? total.minimum : 0, any ? total.maximum : 0);
    if constexpr (std::is_floating_point_v<T>) {
      if (any) bin_floats(bin, info.histogram);
    } else {
      for (std::size_t value = 0; value < total.counts.size(); ++value)
        if (total.counts[value]) info.histogram[bin(double(value))] += total.counts[value];
    }
    const double bias =
        double(std::numeric_limits<T>::is_integer ? std::numeric_limits<T>::min() : T(0));
    info.minimum = any ? total.minimum + bias : 0;
    info.maximum = any ? total.maximum + bias : 0;
  }

  void bin_floats(const Binning& bin, std::vector<std::uint64_t>& histogram) const {
    const std::size_t count = std::size_t(size_.x) * std::size_t(size_.y) * std::size_t(size_.z);
    tbb::enumerable_thread_specific<std::vector<std::uint64_t>> parts{
        std::vector<std::uint64_t>(kBins)};
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, std::size_t(1) << 16),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        auto& part = parts.local();
                        for (std::size_t i = range.begin(); i < range.end(); ++i)
                          if (std::isfinite(linear_[i])) ++part[bin(double(linear_[i]))];
                      });
    for (const auto& part : parts)
      for (std::size_t i = 0; i < kBins; ++i) histogram[i] += part[i];
  }

  glm::ivec3 size_;
  BrickLayout layout_;
  glm::ivec3 cell_counts_;
  const T* linear_;
  S* voxels_;
  CellRange* cells_;
  tbb::enumerable_thread_specific<Tally> tallies_;
};

static_assert(BrickLayout::kEdgeY == kCellEdge && BrickLayout::kEdgeZ == kCellEdge &&
                  BrickLayout::kEdgeX % kCellEdge == 0,
              "a row of bricks is a row of cells");

struct AlignedDelete {
  void operator()(const std::byte* memory) const {
    ::operator delete(const_cast<std::byte*>(memory), std::align_val_t(kBlockAlignment));
  }
};

}  // namespace

void fill_block(VolumeInfo& info, std::span<const std::byte> linear_voxels,
                std::span<std::byte> block) {
  assert(linear_voxels.size() == info.geometry.voxel_count() * bytes_per_voxel(info.type));
  assert(block.size() >= Volume::block_bytes(info.geometry, info.type));
  const auto fill = [&]<class T>(T) {
    BlockFiller<T>(info.geometry, info.type, linear_voxels.data(), block.data()).run(info);
  };
  switch (info.type) {
    case VoxelType::kUInt8:
      fill(std::uint8_t{});
      break;
    case VoxelType::kInt8:
      fill(std::int8_t{});
      break;
    case VoxelType::kUInt16:
      fill(std::uint16_t{});
      break;
    case VoxelType::kInt16:
      fill(std::int16_t{});
      break;
    case VoxelType::kFloat32:
      fill(float{});
      break;
  }
}

std::shared_ptr<const Volume> build_volume(VolumeInfo info,
                                           std::span<const std::byte> linear_voxels) {
  const std::size_t bytes = Volume::block_bytes(info.geometry, info.type);
  auto* memory = static_cast<std::byte*>(
      ::operator new(bytes, std::align_val_t(kBlockAlignment), std::nothrow));
  if (!memory)
    throw FatalError({info.file,
                      "no memory for its " + std::to_string(bytes >> 20) + " MiB of bricks",
                      "use a machine with more memory", ExitStatus::kClusterFailed});
  std::shared_ptr<const std::byte> block(memory, AlignedDelete{});
  fill_block(info, linear_voxels, {memory, bytes});
  return std::make_shared<const Volume>(std::move(info), std::move(block));
}

}  // namespace goldthread
