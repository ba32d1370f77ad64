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

// Slices of voxels in memory, from slice `first` on.
template <class T>
struct SliceWindow {
  const T* voxels = nullptr;
  int first = 0;
};

// What a slab knows of cells that are not its own.
constexpr CellRange kAnything{-std::numeric_limits<float>::infinity(),
                              std::numeric_limits<float>::infinity()};

// One volume of one type, or a slab of it, on its way into its block.
template <class T>
class BlockFiller {
 public:
  using S = Stored<T>;

  BlockFiller(const VolumeGeometry& geometry, VoxelType type, const Slab& slab, std::byte* block)
      : size_(geometry.size),
        slab_(slab),
        layout_(geometry.size, int(sizeof(S)), slab),
        cell_counts_(Volume::cell_counts(geometry)),
        known_layers_(known_layers(slab, geometry.size.z)),
        rows_(std::max(cell_counts_.y, layers_of(layout_.columns.y * ColumnLayout::kEdge))),
        voxels_(block),
        cells_(reinterpret_cast<CellRange*>(block + Volume::cells_offset(geometry, type, slab))) {}

  /// Layers of blocks of 8³ that hold all stored voxels and all own cells.
  LayerRange layers() const {
    return {layout_.first_slice / kCellEdge,
            std::max(slab_.last_layer, layers_of(layout_.first_slice + layout_.slices))};
  }
  /// The slices that layers [first, last) are made from.
  LayerRange slices_for(LayerRange range) const {
    return {std::clamp(range.first * kCellEdge - 1, 0, size_.z - 1),
            std::clamp(range.last * kCellEdge, 0, size_.z - 1) + 1};
  }

  void fill(LayerRange range, SliceWindow<T> window) {
    const int rows = rows_ * range.count();
    tbb::parallel_for(tbb::blocked_range<int>(0, rows), [&](const tbb::blocked_range<int>& part) {
      Tally& tally = tallies_.local();
      tally.counts.resize(kCountedValues);
      RowBuffers buffers(size_.x, layout_.columns.x * ColumnLayout::kEdge);
      for (int row = part.begin(); row < part.end(); ++row)
        fill_row_of_blocks(row % rows_, range.first + row / rows_, window, buffers, tally);
    });
  }

  /// All of the layers are filled. `linear` is the whole volume's voxels if they are at hand: of
  /// floats a histogram is made from them.
  void finish(VolumeInfo& info, const T* linear) {
    mark_unknown_cells();
    summarize(info, linear);
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
  void fill_row_of_blocks(int by, int bz, SliceWindow<T> window, RowBuffers& buffers,
                          Tally& tally) {
    std::fill(buffers.least.begin(), buffers.least.end(), kGreatest);
    std::fill(buffers.greatest.begin(), buffers.greatest.end(), kLeast);
    const glm::ivec2 extent(size_.y, size_.z);
    const bool has_cells = by < cell_counts_.y && bz >= slab_.first_layer && bz < slab_.last_layer;
    for (int z = -1; z <= kCellEdge; ++z) {
      for (int y = -1; y <= kCellEdge; ++y) {
        const glm::ivec2 wanted(by * kCellEdge + y, bz * kCellEdge + z);
        const glm::ivec2 at = glm::clamp(wanted, glm::ivec2(0), extent - 1);
        const glm::ivec2 stored = wanted + ColumnLayout::kApron;
        const bool is_stored = y + 1 < kCellEdge && z + 1 < kCellEdge &&
                               stored.x < layout_.columns.y * ColumnLayout::kEdge &&
                               stored.y >= layout_.first_slice &&
                               stored.y < layout_.first_slice + layout_.slices;
        const bool in_cells = has_cells && y >= 0 && z >= 0 && at == wanted;
        if (!is_stored && !in_cells) continue;
        read_row(at.x, at.y, window, buffers.row);
        if (is_stored) write_row(stored.x, stored.y, buffers.row);
        if (in_cells) widen_ranges(buffers);
        if (in_cells && y < kCellEdge && z < kCellEdge) count_row(buffers.row, tally);
      }
    }
    if (has_cells) write_cells(by, bz, buffers, tally);
  }

  // A row of voxels, its ends repeated to fill the row.
  void read_row(int y, int z, SliceWindow<T> window, std::vector<S>& row) const {
    const auto width = std::size_t(size_.x);
    const T* from = window.voxels +
                    (std::size_t(z - window.first) * std::size_t(size_.y) + std::size_t(y)) * width;
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
    const std::int64_t first =
        (std::int64_t(bz - known_layers_.first) * cell_counts_.y + by) * cell_counts_.x;
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

  void mark_unknown_cells() {
    const std::int64_t in_layer = std::int64_t(cell_counts_.x) * cell_counts_.y;
    for (int layer = known_layers_.first; layer < known_layers_.last; ++layer) {
      if (layer >= slab_.first_layer && layer < slab_.last_layer) continue;
      std::fill_n(cells_ + (layer - known_layers_.first) * in_layer, in_layer, kAnything);
    }
  }

  void summarize(VolumeInfo& info, const T* linear) {
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
      if (any && linear != nullptr) bin_floats(bin, linear, info.histogram);
    } else {
      for (std::size_t value = 0; value < total.counts.size(); ++value)
        if (total.counts[value]) info.histogram[bin(double(value))] += total.counts[value];
    }
    const double bias =
        double(std::numeric_limits<T>::is_integer ? std::numeric_limits<T>::min() : T(0));
    info.minimum = any ? total.minimum + bias : 0;
    info.maximum = any ? total.maximum + bias : 0;
  }

  void bin_floats(const Binning& bin, const T* linear,
                  std::vector<std::uint64_t>& histogram) const {
    const std::size_t count = std::size_t(size_.x) * std::size_t(size_.y) * std::size_t(size_.z);
    tbb::enumerable_thread_specific<std::vector<std::uint64_t>> parts{
        std::vector<std::uint64_t>(kBins)};
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, std::size_t(1) << 16),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        auto& part = parts.local();
                        for (std::size_t i = range.begin(); i < range.end(); ++i)
                          if (std::isfinite(linear[i])) ++part[bin(double(linear[i]))];
                      });
    for (const auto& part : parts)
      for (std::size_t i = 0; i < kBins; ++i) histogram[i] += part[i];
  }

  glm::ivec3 size_;
  Slab slab_;
  ColumnLayout layout_;
  glm::ivec3 cell_counts_;
  LayerRange known_layers_;
  int rows_;  ///< of blocks of 8³ voxels along y that hold all cells and all stored voxels
  std::byte* voxels_;
  CellRange* cells_;
  tbb::enumerable_thread_specific<Tally> tallies_;
};

/// Calls `f` with a number of the type.
template <class F>
void with_voxel_type(VoxelType type, F f) {
  switch (type) {
    case VoxelType::kUInt8:
      return f(std::uint8_t{});
    case VoxelType::kInt8:
      return f(std::int8_t{});
    case VoxelType::kUInt16:
      return f(std::uint16_t{});
    case VoxelType::kInt16:
      return f(std::int16_t{});
    case VoxelType::kFloat32:
      return f(float{});
  }
}

// Counts a volume's own voxels where they lie: a row of columns at a time, column by column, so
// that memory is read in order.
template <class S>
class VoxelCounter {
 public:
  VoxelCounter(const Volume& volume, Binning bin)
      : layout_(volume.layout()),
        voxels_(volume.voxels()),
        own_(own_slices(volume.slab(), layout_.size.z)),
        bin_(bin) {}

  void add_to(std::vector<std::uint64_t>& histogram) const {
    tbb::enumerable_thread_specific<std::vector<std::uint64_t>> parts{
        std::vector<std::uint64_t>(kBins)};
    tbb::parallel_for(0, layout_.columns.y, [&](int row) {
      for (int column = 0; column < layout_.columns.x; ++column)
        count_column(column * ColumnLayout::kEdge, row * ColumnLayout::kEdge, parts.local());
    });
    for (const auto& part : parts)
      for (std::size_t i = 0; i < kBins; ++i) histogram[i] += part[i];
  }

 private:
  // The column that begins at a voxel in stored coordinates; its edge may be apron.
  void count_column(int x, int y, std::vector<std::uint64_t>& counts) const {
    constexpr int kApron = ColumnLayout::kApron;
    const int x_begin = std::max(x, kApron), y_begin = std::max(y, kApron);
    const int x_end = std::min(x + ColumnLayout::kEdge, layout_.size.x + kApron);
    const int y_end = std::min(y + ColumnLayout::kEdge, layout_.size.y + kApron);
    for (int z = own_.first + kApron; z < own_.last + kApron; ++z)
      for (int j = y_begin; j < y_end; ++j) {
        const std::byte* first = voxels_ + layout_.offset(x_begin, j, z);
        for (int i = 0; i < x_end - x_begin; ++i) count(first + i, counts);
      }
  }

  void count(const std::byte* first, std::vector<std::uint64_t>& counts) const {
    std::array<std::byte, sizeof(S)> bytes;
    for (std::size_t plane = 0; plane < sizeof(S); ++plane)
      bytes[plane] = first[std::int64_t(plane) * layout_.plane_bytes];
    const double value = double(std::bit_cast<S>(bytes));
    if (std::isfinite(value)) ++counts[bin_(value)];
  }

  const ColumnLayout& layout_;
  const std::byte* voxels_;
  LayerRange own_;
  Binning bin_;
};

/// Of a file's slices in memory at a time, beside the block that is made from them.
constexpr std::int64_t kWindowBytes = std::int64_t(1) << 25;

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
  with_voxel_type(info.type, [&]<class T>(T) {
    BlockFiller<T> filler(info.geometry, info.type, whole_slab(info.geometry.size.z), block.data());
    const T* linear = reinterpret_cast<const T*>(linear_voxels.data());
    filler.fill(filler.layers(), {linear, 0});
    filler.finish(info, linear);
  });
}

std::optional<Failure> fill_slab(VolumeInfo& info, const Slab& slab, const SliceReader& read,
                                 std::span<std::byte> block,
                                 const std::function<void(double)>& progress) {
  assert(block.size() >= Volume::block_bytes(info.geometry, info.type, slab));
  std::optional<Failure> failure;
  with_voxel_type(info.type, [&]<class T>(T) {
    BlockFiller<T> filler(info.geometry, info.type, slab, block.data());
    const glm::i64vec3 size = info.geometry.size;
    const std::int64_t slice_bytes = size.x * size.y * std::int64_t(sizeof(T));
    const int at_once = int(std::max<std::int64_t>(1, kWindowBytes / slice_bytes / kCellEdge));
    std::vector<T> window;
    const LayerRange all = filler.layers();
    for (int first = all.first; first < all.last && !failure; first += at_once) {
      const LayerRange range{first, std::min(first + at_once, all.last)};
      const LayerRange slices = filler.slices_for(range);
      window.resize(std::size_t(size.x * size.y * slices.count()));
      failure = read(slices.first, slices.count(), std::as_writable_bytes(std::span(window)));
      if (failure) return;
      filler.fill(range, {window.data(), slices.first});
      if (progress) progress(double(range.last - all.first) / double(all.count()));
    }
    if (!failure) filler.finish(info, nullptr);
  });
  return failure;
}

std::vector<std::uint64_t> count_voxels(const Volume& volume, double minimum, double maximum) {
  std::vector<std::uint64_t> histogram(kBins);
  with_voxel_type(volume.info().type, [&]<class T>(T) {
    const Binning bin(minimum - volume.value_bias(), maximum - volume.value_bias());
    VoxelCounter<Stored<T>>(volume, bin).add_to(histogram);
  });
  return histogram;
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
