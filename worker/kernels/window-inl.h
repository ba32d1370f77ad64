// SPDX-License-Identifier: Apache-2.0
// Voxels for a packet without gathers. Neighbouring rays are close to each other at equal depth, so
// the voxels of all their samples lie in one window of 8³, four column runs of 128 bytes each
// (ColumnLayout), and are taken from there by permutations of bytes in registers. What a lane gets
// does not depend on its company.

#if defined(GOLDTHREAD_WORKER_KERNELS_WINDOW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_WINDOW_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_WINDOW_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_WINDOW_INL_H_
#endif

#include <algorithm>
#include <limits>

#include "worker/kernels/kernel_types.h"
#include "worker/kernels/lone_voxels-inl.h"
#include "worker/kernels/ray_packet-inl.h"
#include "worker/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

/// One lane needs no window: its voxels are read from where they lie.
template <int kReach>
class Window : public LoneVoxels {
 public:
  using LoneVoxels::LoneVoxels;
  HWY_INLINE bool reaches(const Ints3&, FloatMask) const { return true; }
  HWY_INLINE FloatMask reached(const Ints3&, FloatMask lanes) const { return lanes; }
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
  /// Positions of a cell in the window that leave room for its reach on both sides.
  static constexpr int kRoom = 6 - 2 * kReach;

 public:
  HWY_INLINE explicit Window(const FieldLayout& layout)
      : layout_(layout),
        byte_3_(hn::Set(kBytes, std::uint8_t(unknown(3)))),
        byte_12_(hn::Set(kBytes, std::uint8_t(unknown(12)))),
        byte_4_(hn::Set(kBytes, std::uint8_t(unknown(4)))),
        byte_32_(hn::Set(kBytes, std::uint8_t(unknown(32)))),
        byte_16_(hn::Set(kBytes, std::uint8_t(unknown(16)))) {
    move_to(0, 0, 0);
  }

  /// Lays the window over the cells of all `lanes`, `at` their lower corners; false where it does
  /// not reach.
  HWY_INLINE bool reaches(const Ints3& at, FloatMask lanes) {
    if (hn::AllFalse(kFloats, hn::AndNot(contains(at), lanes))) return true;
    move_to_lowest(at, lanes);
    return hn::AllFalse(kFloats, hn::AndNot(contains(at), lanes));
  }

  /// Those of `lanes` that it does reach.
  HWY_INLINE FloatMask reached(const Ints3& at, FloatMask lanes) const {
    return hn::And(lanes, contains(at));
  }

  /// How large a box lie() can take in.
  static constexpr float kBeamEdges[3] = {float(kRoom - 3), float(kRoom - 3), float(kRoom)};

  /// What no window takes in, wherever it begins.
  static constexpr float kMostEdges[3] = {float(kRoom + 1), float(kRoom + 1), float(kRoom + 1)};

  /// Lays the window over a beam, which must be narrow, at segments `first` … `last`. Waits for
  /// nothing and decides nothing, so that it is done long before its voxels are needed.
  HWY_INLINE void lie(const Beam& beam, float first, float last) {
    fetch_ahead(corner_of(origin_at(beam, first + kAhead, last + kAhead)));
    const IntPoint origin = origin_at(beam, first, last);
    corner_ = corner_of(origin);
    const IntPoint voxel = hn::Sub(origin, hn::Set(kIntPoint, 1));
    origin_ = {everywhere<0>(voxel), everywhere<1>(voxel), everywhere<2>(voxel)};
  }

  /// The eight voxels of each lane's cell, slice by slice.
  HWY_INLINE void take_cell(const Ints3& at, FloatMask lanes, int plane, Bytes (&slices)[2]) const {
    take<0, 1, 0, 1, 0, 2>(place(at), lanes, plane, slices);
  }
  /// The same and what lies around them: four slices of the cell, from the one before it on, then
  /// in its own two what lies beside it along x, and along y.
  HWY_INLINE void take_around(const Ints3& at, FloatMask lanes, int plane,
                              Bytes (&slices)[8]) const {
    const Place in_window = place(at);
    take<0, 1, 0, 1, -1, 4>(in_window, lanes, plane, slices);
    take<-1, 2, 0, 1, 0, 2>(in_window, lanes, plane, slices + 4);
    take<0, 1, -1, 2, 0, 2>(in_window, lanes, plane, slices + 6);
  }

 private:
  /// Where a lane's cell lies in the window, as bytes.
  struct Place {
    Bytes xy;  ///< x + 8·y
    Ints z;
  };
  HWY_INLINE Place place(const Ints3& at) const {
    const Ints x = hn::Sub(at.x, origin_.x);
    const Ints y = hn::Sub(at.y, origin_.y);
    const Ints z = hn::Sub(at.z, origin_.z);
    return {low_byte_everywhere(hn::Add(x, hn::ShiftLeft<3>(y))), z};
  }

  /// Of one plane, four voxels a lane in its four bytes: (kX0, kY0), (kX1, kY0), (kX0, kY1),
  /// (kX1, kY1) from the cell's lower corner, and that in kCount slices from kFirstZ on.
  template <int kX0, int kX1, int kY0, int kY1, int kFirstZ, int kCount>
  HWY_INLINE void take(const Place& place, FloatMask lanes, int plane, Bytes* slices) const {
    constexpr std::int32_t kOffsets =
        four_bytes(kX0 + 8 * kY0, kX1 + 8 * kY0, kX0 + 8 * kY1, kX1 + 8 * kY1);
    const Bytes q = hn::Add(place.xy, hn::BitCast(kBytes, hn::Set(kInts, kOffsets)));
    // Bits of q: xx·X yy·Y, X and Y which of two columns. In a slice: xx yy.
    const auto shorts = hn::BitCast(hn::Repartition<std::uint16_t, FloatTag>(), q);
    const Bytes high = hn::BitCast(kBytes, hn::ShiftRight<1>(shorts));
    const Bytes in_slice = hn::Or(hn::And(q, byte_3_), hn::And(high, byte_12_));
    const std::uint8_t* run = corner_ + plane * layout_.plane_bytes;
    look_up<kFirstZ, kCount>(run, q, in_slice, place.z, lanes, slices);
  }

  using IntPointTag = hn::Simd<std::int32_t, 4, 0>;
  using IntPoint = hn::Vec<IntPointTag>;
  static constexpr IntPointTag kIntPoint{};
  static constexpr float kAhead = 6;  ///< segments

  /// In stored coordinates.
  HWY_INLINE IntPoint origin_at(const Beam& beam, float first, float last) const {
    alignas(16) static constexpr std::int32_t kAligned[4] = {~3, ~3, ~0, 0};
    const auto cell = hn::ConvertTo(kIntPoint, hn::Max(beam.lowest(first, last), hn::Zero(kPoint)));
    const auto stored = hn::Max(hn::Add(cell, hn::Set(kIntPoint, 1 - kReach)),
                                hn::Load(kIntPoint, layout_.first_origin));
    return hn::And(hn::Min(stored, hn::Load(kIntPoint, layout_.last_origin)),
                   hn::Load(kIntPoint, kAligned));
  }
  HWY_INLINE const std::uint8_t* corner_of(IntPoint origin) const {
    alignas(16) std::int32_t at[4];
    hn::Store(origin, kIntPoint, at);
    return corner_of(at[0], at[1], at[2]);
  }
  HWY_INLINE const std::uint8_t* corner_of(std::int32_t x, std::int32_t y, std::int32_t z) const {
    return layout_.voxels + (x >> 2) * layout_.column_bytes + (y >> 2) * layout_.row_bytes +
           std::int64_t(z) * 16;
  }
  /// What the window will hold soon, into the nearest cache.
  HWY_INLINE void fetch_ahead(const std::uint8_t* corner) const {
    const std::int64_t columns[4] = {0, layout_.column_bytes, layout_.row_bytes,
                                     layout_.row_bytes + layout_.column_bytes};
    for (const std::int64_t column : columns) {
      __builtin_prefetch(corner + column);
      __builtin_prefetch(corner + column + 64);
    }
  }

  template <int kLane, class V>
  static HWY_INLINE Ints everywhere(V v) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
    return Ints{_mm512_broadcastd_epi32(_mm_shuffle_epi32(v.raw, kLane * 0x55))};
#elif HWY_TARGET == HWY_AVX2
    return Ints{_mm256_broadcastd_epi32(_mm_shuffle_epi32(v.raw, kLane * 0x55))};
#else
    return hn::Broadcast<kLane>(v);
#endif
  }

  HWY_INLINE FloatMask contains(const Ints3& at) const {
    const Ints reach = hn::Set(kInts, kReach);
    const auto along = [&](Ints v, Ints origin) HWY_ATTR {
      const Ints local = hn::Sub(v, origin);
      return hn::BitCast(kUnsigned, kReach > 0 ? hn::Sub(local, reach) : local);
    };
    const auto most =
        hn::Max(along(at.x, origin_.x), hn::Max(along(at.y, origin_.y), along(at.z, origin_.z)));
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
  HWY_INLINE void move_to(std::int32_t x, std::int32_t y, std::int32_t z) {
    // Stored coordinates: voxel + 1.
    const auto begin = [&](std::int32_t v, int axis) {
      return std::clamp(v + 1 - kReach, layout_.first_origin[axis], layout_.last_origin[axis]);
    };
    const std::int32_t x0 = begin(x, 0) & ~3, y0 = begin(y, 1) & ~3, z0 = begin(z, 2);
    origin_ = {hn::Set(kInts, x0 - 1), hn::Set(kInts, y0 - 1), hn::Set(kInts, z0 - 1)};
    corner_ = corner_of(x0, y0, z0);
  }

#if HWY_TARGET == HWY_AVX3_DL
  /// 128 bytes of a run are two registers: one permutation each, then choose between the columns.
  template <int kFirstZ, int kCount>
  HWY_INLINE void look_up(const std::uint8_t* run, Bytes q, Bytes in_slice, Ints z, FloatMask,
                          Bytes* slices) const {
    const auto column = [&](std::int64_t offset, Bytes index) HWY_ATTR {
      return Bytes{_mm512_permutex2var_epi8(_mm512_loadu_si512(run + offset), index.raw,
                                            _mm512_loadu_si512(run + offset + 64))};
    };
    const auto right = hn::TestBit(q, byte_4_);
    const auto behind = hn::TestBit(q, byte_32_);
    const Bytes z_bits = low_byte_everywhere(hn::ShiftLeft<4>(z));
    Bytes index = hn::Or(in_slice, kFirstZ < 0 ? hn::Sub(z_bits, byte_16_) : z_bits);
    static_assert(kFirstZ == 0 || kFirstZ == -1);
    GOLDTHREAD_UNROLL
    for (int i = 0; i < kCount; ++i) {
      if (i > 0) index = hn::Add(index, byte_16_);
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
                          Bytes* slices) const {
    const auto wanted = hn::RebindMask(kInts, lanes);
    const Ints some = hn::IfThenElse(wanted, z, hn::Set(kInts, origin_room()));
    const int first = hn::GetLane(hn::MinOfLanes(kInts, some));
    const int last = hn::GetLane(hn::MaxOfLanes(kInts, hn::IfThenElseZero(wanted, z)));
    // Index 128 and more gives 0: each lane reads from its own column only.
    const Bytes none = hn::Set(kBytes, 128);
    const auto right = hn::TestBit(q, byte_4_);
    const auto behind = hn::TestBit(q, byte_32_);
    const Bytes front_index = hn::IfThenElse(behind, none, in_slice);
    const Bytes back_index = hn::IfThenElse(behind, in_slice, none);
    const Bytes indices[4] = {
        hn::IfThenElse(right, none, front_index), hn::IfThenElse(right, front_index, none),
        hn::IfThenElse(right, none, back_index), hn::IfThenElse(right, back_index, none)};
    const std::int64_t offsets[4] = {0, layout_.column_bytes, layout_.row_bytes,
                                     layout_.row_bytes + layout_.column_bytes};
    for (int i = 0; i < kCount; ++i) slices[i] = hn::Zero(kBytes);
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
  Ints3 origin_;  ///< the window's first voxel, the same in all lanes
  const std::uint8_t* corner_ = nullptr;
  Bytes byte_3_, byte_12_, byte_4_, byte_32_, byte_16_;
};

#endif  // HWY_TARGET == HWY_SCALAR

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
