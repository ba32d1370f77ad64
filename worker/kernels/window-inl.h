// SPDX-License-Identifier: Apache-2.0
// Voxels for a packet without gathers. Neighbouring rays are close to each other at equal depth, so
// the voxels of all their samples lie in one window of 8³, four column runs of 128 bytes each
// (ColumnLayout), and are taken from there by permutations of bytes in registers. Where a packet is
// wider, windows are laid over its lanes one after the other until each had its turn; what a lane
// gets does not depend on its company.

#if defined(GOLDTHREAD_WORKER_KERNELS_WINDOW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_WINDOW_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_WINDOW_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_WINDOW_INL_H_
#endif

#include <algorithm>
#include <limits>

#include "worker/kernels/kernel_types.h"
#include "worker/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
using ByteTag = UnsignedTag;  // four bytes in the one lane
#else
using ByteTag = hn::Repartition<std::uint8_t, FloatTag>;
#endif
using Bytes = hn::Vec<ByteTag>;
constexpr ByteTag kBytes{};

/// Stored coordinates: voxel + 1.
struct Ints3 {
  Ints x, y, z;
};

#if HWY_TARGET == HWY_SCALAR

/// One lane needs no window: its voxels are read from where they lie.
template <int kReach>
class Window {
 public:
  HWY_INLINE explicit Window(const FieldLayout& layout) : layout_(layout) {}

  HWY_INLINE bool reaches(const Ints3&, FloatMask) const { return true; }
  template <class Use>
  HWY_INLINE void cover(const Ints3&, FloatMask, Use&&) const {}
  using Place = Ints3;
  HWY_INLINE Place place(const Ints3& at) const { return at; }

  template <int kX0, int kX1, int kY0, int kY1, int kFirstZ, int kCount>
  HWY_INLINE void take(const Place& at, FloatMask, int plane, Bytes (&slices)[kCount]) const {
    const std::uint8_t* voxels = layout_.voxels + plane * layout_.plane_bytes;
    const int x = hn::GetLane(at.x), y = hn::GetLane(at.y), z = hn::GetLane(at.z);
    const auto voxel = [&](int i, int j, int k) {
      return std::uint32_t(voxels[(i >> 2) * layout_.column_bytes + (j >> 2) * layout_.row_bytes +
                                  std::int64_t(k) * 16 + (j & 3) * 4 + (i & 3)]);
    };
    for (int s = 0; s < kCount; ++s) {
      const int k = z + kFirstZ + s;
      slices[s] =
          hn::Set(kBytes, voxel(x + kX0, y + kY0, k) | voxel(x + kX1, y + kY0, k) << 8 |
                              voxel(x + kX0, y + kY1, k) << 16 | voxel(x + kX1, y + kY1, k) << 24);
    }
  }

 private:
  const FieldLayout& layout_;
};

#else

/// A byte pattern repeated in each lane of 32 bits, the first byte lowest; modulo 256.
constexpr std::int32_t four_bytes(int a, int b, int c, int d) {
  const auto byte = [](int v, int place) { return (std::uint32_t(v) & 255U) << (8 * place); };
  return std::int32_t(byte(a, 0) | byte(b, 1) | byte(c, 2) | byte(d, 3));
}

/// The lowest byte of each lane of 32 bits in all its four.
HWY_INLINE Bytes low_byte_everywhere(Ints v) {
  alignas(16) static constexpr std::uint8_t kPattern[16] = {0, 0, 0, 0, 4,  4,  4,  4,
                                                            8, 8, 8, 8, 12, 12, 12, 12};
  return hn::TableLookupBytes(hn::BitCast(kBytes, v), hn::LoadDup128(kBytes, kPattern));
}

/// A window as one sees it from each lane. kReach is how many voxels below the lane's own cell
/// and above it are wanted: 0 for values, 1 for gradients.
template <int kReach>
class Window {
 public:
  HWY_INLINE explicit Window(const FieldLayout& layout) : layout_(layout) { move_to(0, 0, 0); }

  /// Lays the window over the cells of all `lanes`, `at` their lower corners; false where it does
  /// not reach, then cover() must be used.
  HWY_INLINE bool reaches(const Ints3& at, FloatMask lanes) {
    if (hn::AllFalse(kFloats, hn::AndNot(contains(at), lanes))) return true;
    move_to_lowest(at, lanes);
    return hn::AllFalse(kFloats, hn::AndNot(contains(at), lanes));
  }

  /// Calls use(lanes) with the window on some of `lanes` until all have had their turn.
  template <class Use>
  HWY_INLINE void cover(const Ints3& at, FloatMask lanes, Use&& use) {
    while (!hn::AllFalse(kFloats, lanes)) {
      move_to_first(at, lanes);
      const FloatMask inside = hn::And(lanes, contains(at));
      use(inside);
      lanes = hn::AndNot(inside, lanes);
    }
  }

  /// Where a lane's cell lies in the window, as bytes.
  struct Place {
    Bytes xy;  ///< x + 8·y
    Ints z;
  };
  HWY_INLINE Place place(const Ints3& at) const {
    const Ints x = hn::Sub(at.x, hn::Set(kInts, origin_[0]));
    const Ints y = hn::Sub(at.y, hn::Set(kInts, origin_[1]));
    const Ints z = hn::Sub(at.z, hn::Set(kInts, origin_[2]));
    return {low_byte_everywhere(hn::Add(x, hn::ShiftLeft<3>(y))), z};
  }

  /// Of one plane, four voxels a lane in its four bytes: (kX0, kY0), (kX1, kY0), (kX0, kY1),
  /// (kX1, kY1) from the cell's lower corner, and that in kCount slices from kFirstZ on.
  template <int kX0, int kX1, int kY0, int kY1, int kFirstZ, int kCount>
  HWY_INLINE void take(const Place& place, FloatMask lanes, int plane,
                       Bytes (&slices)[kCount]) const {
    constexpr std::int32_t kOffsets =
        four_bytes(kX0 + 8 * kY0, kX1 + 8 * kY0, kX0 + 8 * kY1, kX1 + 8 * kY1);
    const Bytes q = hn::Add(place.xy, hn::BitCast(kBytes, hn::Set(kInts, kOffsets)));
    // Bits of q: xx·X yy·Y, X and Y which of two columns. In a slice: xx yy.
    const auto shorts = hn::BitCast(hn::Repartition<std::uint16_t, FloatTag>(), q);
    const Bytes high = hn::BitCast(kBytes, hn::ShiftRight<1>(shorts));
    const Bytes in_slice =
        hn::Or(hn::And(q, hn::Set(kBytes, 3)), hn::And(high, hn::Set(kBytes, 12)));
    const std::uint8_t* run = corner_ + plane * layout_.plane_bytes;
    look_up<kFirstZ, kCount>(run, q, in_slice, place.z, lanes, slices);
  }

 private:
  /// Positions of a cell in the window that leave room for its reach on both sides.
  static constexpr int kRoom = 6 - 2 * kReach;

  HWY_INLINE FloatMask contains(const Ints3& at) const {
    const auto along = [&](Ints v, int axis) HWY_ATTR {
      return hn::BitCast(kUnsigned, hn::Sub(v, hn::Set(kInts, origin_[axis] + kReach)));
    };
    const auto most = hn::Max(along(at.x, 0), hn::Max(along(at.y, 1), along(at.z, 2)));
    const auto bounded = hn::Min(most, hn::Set(kUnsigned, std::uint32_t(kRoom)));
    return hn::RebindMask(kFloats, hn::Eq(most, bounded));
  }

  HWY_INLINE void move_to_lowest(const Ints3& at, FloatMask lanes) {
    const auto lowest = [&](Ints v) HWY_ATTR {
      const auto wanted = hn::RebindMask(kInts, lanes);
      const Ints none = hn::Set(kInts, std::numeric_limits<std::int32_t>::max());
      return hn::GetLane(hn::MinOfLanes(kInts, hn::IfThenElse(wanted, v, none)));
    };
    move_to(lowest(at.x), lowest(at.y), lowest(at.z));
  }
  HWY_INLINE void move_to_first(const Ints3& at, FloatMask lanes) {
    HWY_ALIGN std::int32_t x[hn::MaxLanes(kInts)], y[hn::MaxLanes(kInts)], z[hn::MaxLanes(kInts)];
    hn::Store(at.x, kInts, x);
    hn::Store(at.y, kInts, y);
    hn::Store(at.z, kInts, z);
    const auto i = std::size_t(hn::FindFirstTrue(kFloats, lanes));
    move_to(x[i], y[i], z[i]);
  }
  HWY_INLINE void move_to(std::int32_t x, std::int32_t y, std::int32_t z) {
    const auto begin = [&](std::int32_t v, int axis) {
      return std::clamp(v - kReach, 0, layout_.last_origin[axis]);
    };
    origin_[0] = begin(x, 0) & ~3;
    origin_[1] = begin(y, 1) & ~3;
    origin_[2] = begin(z, 2);
    corner_ = layout_.voxels + (origin_[0] >> 2) * layout_.column_bytes +
              (origin_[1] >> 2) * layout_.row_bytes + std::int64_t(origin_[2]) * 16;
  }

#if HWY_TARGET == HWY_AVX3_DL
  /// 128 bytes of a run are two registers: one permutation each, then choose between the columns.
  template <int kFirstZ, int kCount>
  HWY_INLINE void look_up(const std::uint8_t* run, Bytes q, Bytes in_slice, Ints z, FloatMask,
                          Bytes (&slices)[kCount]) const {
    const auto column = [&](std::int64_t offset, Bytes index) HWY_ATTR {
      return Bytes{_mm512_permutex2var_epi8(_mm512_loadu_si512(run + offset), index.raw,
                                            _mm512_loadu_si512(run + offset + 64))};
    };
    const auto right = hn::TestBit(q, hn::Set(kBytes, 4));
    const auto behind = hn::TestBit(q, hn::Set(kBytes, 32));
    const Bytes z_bits = low_byte_everywhere(hn::ShiftLeft<4>(z));
    for (int i = 0; i < kCount; ++i) {
      const Bytes index =
          hn::Or(in_slice, hn::Add(z_bits, hn::Set(kBytes, std::uint8_t(16 * (kFirstZ + i)))));
      const Bytes front =
          hn::IfThenElse(right, column(layout_.column_bytes, index), column(0, index));
      const Bytes back =
          hn::IfThenElse(right, column(layout_.row_bytes + layout_.column_bytes, index),
                         column(layout_.row_bytes, index));
      slices[i] = hn::IfThenElse(behind, back, front);
    }
  }
#else
  /// A slice of a column is one register block: those of the slices that any lane wants are
  /// permuted one after the other, and each lane keeps its own.
  template <int kFirstZ, int kCount>
  HWY_INLINE void look_up(const std::uint8_t* run, Bytes q, Bytes in_slice, Ints z, FloatMask lanes,
                          Bytes (&slices)[kCount]) const {
    const auto wanted = hn::RebindMask(kInts, lanes);
    const Ints some = hn::IfThenElse(wanted, z, hn::Set(kInts, origin_room()));
    const int first = hn::GetLane(hn::MinOfLanes(kInts, some));
    const int last = hn::GetLane(hn::MaxOfLanes(kInts, hn::IfThenElseZero(wanted, z)));
    // Index 128 and more gives 0: each lane reads from its own column only.
    const Bytes none = hn::Set(kBytes, 128);
    const auto right = hn::TestBit(q, hn::Set(kBytes, 4));
    const auto behind = hn::TestBit(q, hn::Set(kBytes, 32));
    const Bytes front_index = hn::IfThenElse(behind, none, in_slice);
    const Bytes back_index = hn::IfThenElse(behind, in_slice, none);
    const Bytes indices[4] = {
        hn::IfThenElse(right, none, front_index), hn::IfThenElse(right, front_index, none),
        hn::IfThenElse(right, none, back_index), hn::IfThenElse(right, back_index, none)};
    const std::int64_t offsets[4] = {0, layout_.column_bytes, layout_.row_bytes,
                                     layout_.row_bytes + layout_.column_bytes};
    for (Bytes& slice : slices) slice = hn::Zero(kBytes);
    for (int s = first + kFirstZ; s < last + kFirstZ + kCount; ++s) {
      Bytes here = hn::Zero(kBytes);
      for (int c = 0; c < 4; ++c) {
        const Bytes table = hn::LoadDup128(kBytes, run + offsets[c] + 16 * s);
        here = hn::Or(here, hn::TableLookupBytesOr0(table, indices[c]));
      }
      for (int i = 0; i < kCount; ++i) {
        const auto own = hn::Eq(z, hn::Set(kInts, s - kFirstZ - i));
        const auto mask = hn::BitCast(kBytes, hn::VecFromMask(kInts, own));
        slices[i] = hn::Or(slices[i], hn::And(mask, here));
      }
    }
  }
  static constexpr std::int32_t origin_room() { return kReach + kRoom; }
#endif

  const FieldLayout& layout_;
  std::int32_t origin_[3] = {0, 0, 0};  ///< stored coordinates of the window's first voxel
  const std::uint8_t* corner_ = nullptr;
};

#endif  // HWY_TARGET == HWY_SCALAR

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
