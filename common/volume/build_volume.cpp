// SPDX-License-Identifier: Apache-2.0
#include "common/volume/build_volume.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
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
        layout_(geometry.size, int(sizeof(S))),
        cell_counts_(Volume::cell_counts(geometry)),
        blocks_(glm::max(
            cell_counts_,
            (glm::ivec3(layout_.columns * ColumnLayout::kEdge, layout_.slices) + kCellEdge - 1) /
                kCellEdge)),
        linear_(reinterpret_cast<const T*>(linear)),
        voxels_(block),
        cells_(reinterpret_cast<CellRange*>(block + Volume::cells_offset(geometry, type))) {}

  void run(VolumeInfo& info) {
    const int rows = blocks_.y * blocks_.z;
    tbb::parallel_for(tbb::blocked_range<int>(0, rows), [&](const tbb::blocked_range<int>& range) {
      Tally& tally = tallies_.local();
      tally.counts.resize(kCountedValues);
      RowBuffers buffers(size_.x, layout_.columns.x * ColumnLayout::kEdge);
      for (int row = range.begin(); row < range.end(); ++row)
        fill_row_of_blocks(row % blocks_.y, row / blocks_.y, buffers, tally);
    });
    finish(info);
  }

 private:
  static constexpr std::size_t kCountedValues =
      std::is_floating_point_v<T> ? 0 : std::size_t(1) << (8 * std::min<std::size_t>(sizeof(T), 2));

  // Working memory of one row of blocks: one row of voxels with its apron, and the least and
  // greatest at each x.
  struct RowBuffers {
    RowBuffers(int width, int stored_width)
        : row(std::size_t(stored_width)), least(std::size_t(width)), greatest(std::size_t(width)) {}
    std::vector<S> row, least, greatest;
  };

  static constexpr S kLeast = std::numeric_limits<S>::has_infinity
                                  ? -std::numeric_limits<S>::infinity()
                                  : std::numeric_limits<S>::lowest();
  static constexpr S kGreatest = std::numeric_limits<S>::has_infinity
                                     ? std::numeric_limits<S>::infinity()
                                     : std::numeric_limits<S>::max();

  // The stored rows and the cells of a row of blocks of 8×8. Reads 10×10 rows: stored rows begin
  // one voxel before the cells, which end on their upper neighbours' voxels.
  void fill_row_of_blocks(int by, int bz, RowBuffers& buffers, Tally& tally) {
    std::fill(buffers.least.begin(), buffers.least.end(), kGreatest);
    std::fill(buffers.greatest.begin(), buffers.greatest.end(), kLeast);
    const glm::ivec2 extent(size_.y, size_.z);
    const bool has_cells = by < cell_counts_.y && bz < cell_counts_.z;
    for (int z = -1; z <= kCellEdge; ++z) {
      for (int y = -1; y <= kCellEdge; ++y) {
        const glm::ivec2 wanted(by * kCellEdge + y, bz * kCellEdge + z);
        const glm::ivec2 at = glm::clamp(wanted, glm::ivec2(0), extent - 1);
        const glm::ivec2 stored = wanted + ColumnLayout::kApron;
        const bool is_stored = y + 1 < kCellEdge && z + 1 < kCellEdge &&
                               stored.x < layout_.columns.y * ColumnLayout::kEdge &&
                               stored.y < layout_.slices;
        const bool in_cells = has_cells && y >= 0 && z >= 0 && at == wanted;
        if (!is_stored && !in_cells) continue;
        read_row(at.x, at.y, buffers.row);
        if (is_stored) write_row(stored.x, stored.y, buffers.row);
        if (in_cells) widen_ranges(buffers);
        if (in_cells && y < kCellEdge && z < kCellEdge) count_row(buffers.row, tally);
      }
    }
    if (has_cells) write_cells(by, bz, buffers, tally);
  }

  // A row of voxels, its ends repeated to fill the row.
  void read_row(int y, int z, std::vector<S>& row) const {
    const auto width = std::size_t(size_.x);
    const T* from = linear_ + (std::size_t(z) * std::size_t(size_.y) + std::size_t(y)) * width;
    S* to = row.data() + ColumnLayout::kApron;
    for (std::size_t x = 0; x < width; ++x) to[x] = stored_from(from[x]);
    std::fill(row.data(), to, to[0]);
    std::fill(to + width, row.data() + row.size(), to[width - 1]);
  }

  void widen_ranges(RowBuffers& buffers) const {
    const S* row = buffers.row.data() + ColumnLayout::kApron;
    S* least = buffers.least.data();
    S* greatest = buffers.greatest.data();
    const auto width = std::size_t(size_.x);
    for (std::size_t x = 0; x < width; ++x) {
      const S value = row[x];
      // In this order a NaN compares false and is left out.
      least[x] = value < least[x] ? value : least[x];
      greatest[x] = value > greatest[x] ? value : greatest[x];
    }
  }

  void write_row(int y, int z, const std::vector<S>& row) {
    std::byte* to = voxels_ + layout_.offset(0, y, z);
    for (int column = 0; column < layout_.columns.x; ++column) {
      std::array<S, ColumnLayout::kEdge> four;
      std::memcpy(&four, row.data() + column * ColumnLayout::kEdge, sizeof(four));
      const auto bytes = std::bit_cast<std::array<std::byte, sizeof(four)>>(four);
      for (std::size_t plane = 0; plane < sizeof(S); ++plane) {
        std::array<std::byte, ColumnLayout::kEdge> of_plane;
        for (std::size_t i = 0; i < of_plane.size(); ++i)
          of_plane[i] = bytes[i * sizeof(S) + plane];
        std::memcpy(to + std::int64_t(plane) * layout_.plane_bytes, &of_plane, sizeof(of_plane));
      }
      to += layout_.column_bytes();
    }
  }

  void count_row(const std::vector<S>& row, Tally& tally) const {
    const S* voxels = row.data() + ColumnLayout::kApron;
    const auto width = std::size_t(size_.x);
    if constexpr (std::is_floating_point_v<T>) {
      std::uint64_t not_finite = 0;
      for (std::size_t x = 0; x < width; ++x) not_finite += std::isfinite(voxels[x]) ? 0 : 1;
      tally.not_finite += not_finite;
    } else {
      for (std::size_t x = 0; x < width; ++x) ++tally.counts[voxels[x]];
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
  ColumnLayout layout_;
  glm::ivec3 cell_counts_;
  glm::ivec3 blocks_;  ///< of 8³ voxels that hold all cells and all stored voxels
  const T* linear_;
  std::byte* voxels_;
  CellRange* cells_;
  tbb::enumerable_thread_specific<Tally> tallies_;
};

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
                      "no memory for its " + std::to_string(bytes >> 20) + " MiB of voxels",
                      "use a machine with more memory", ExitStatus::kClusterFailed});
  std::shared_ptr<const std::byte> block(memory, AlignedDelete{});
  fill_block(info, linear_voxels, {memory, bytes});
  return std::make_shared<const Volume>(std::move(info), std::move(block));
}

}  // namespace goldthread
