// SPDX-License-Identifier: Apache-2.0
// The scalar field: trilinear values and gradients at a position per lane, from bricked voxels.
// Positions are voxel indices inside [0, upper]; every address formed from them lies in the block.
// Cost in gathers of 32 bits: a value 4 (uint8, uint16) or 8 (float); a gradient 12, 16 or 32.

#if defined(GOLDTHREAD_WORKER_KERNELS_FIELD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_FIELD_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_FIELD_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_FIELD_INL_H_
#endif

#include <cstring>

#include "worker/kernels/kernel_table.h"
#include "worker/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

/// 32 bits from a byte address per lane, which need not be aligned.
HWY_INLINE Ints gather_bytes(const std::uint8_t* base, Ints offset) {
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
  return hn::GatherOffset(kInts, reinterpret_cast<const std::int32_t*>(base), offset);
#else
  HWY_ALIGN std::int32_t lanes[hn::MaxLanes(kInts)];
  hn::Store(offset, kInts, lanes);
  for (std::int32_t& lane : lanes) std::memcpy(&lane, base + lane, sizeof(lane));
  return hn::Load(kInts, lanes);
#endif
}

/// The low and high bits of a word as numbers.
template <int kShift, int kBits>
HWY_INLINE Floats bits_of(Ints word) {
  const auto shifted = hn::ShiftRight<kShift>(hn::BitCast(kUnsigned, word));
  const auto wanted = hn::And(shifted, hn::Set(kUnsigned, (1U << kBits) - 1));
  return hn::ConvertTo(kFloats, hn::BitCast(kInts, wanted));
}

/// A byte offset per lane, as a sum of one part per axis.
struct NarrowOffset {
  Ints bytes;
};
/// The number of the brick and the place inside it, for volumes that 32 bits of bytes cannot span.
struct WideOffset {
  Ints brick;
  Ints bytes;
};
HWY_INLINE NarrowOffset operator+(NarrowOffset a, NarrowOffset b) {
  return {hn::Add(a.bytes, b.bytes)};
}
HWY_INLINE WideOffset operator+(WideOffset a, WideOffset b) {
  return {hn::Add(a.brick, b.brick), hn::Add(a.bytes, b.bytes)};
}

template <Storage kStorage, Addressing kAddressing>
class Field {
 public:
  /// Integers are always finite.
  static constexpr bool kMayBeInfinite = kStorage == Storage::kFloat32;

  explicit Field(const FieldLayout& layout) : layout_(layout) {}

  /// A place inside a cell of 2³ voxels.
  struct Place {
    Ints x, y, z;
    Floats fx, fy, fz;
  };

  HWY_INLINE Place locate(const Floats3& position) const {
    const Ints x = hn::ConvertTo(kInts, position.x);
    const Ints y = hn::ConvertTo(kInts, position.y);
    const Ints z = hn::ConvertTo(kInts, position.z);
    return {x,
            y,
            z,
            hn::Sub(position.x, hn::ConvertTo(kFloats, x)),
            hn::Sub(position.y, hn::ConvertTo(kFloats, y)),
            hn::Sub(position.z, hn::ConvertTo(kFloats, z))};
  }

  /// What the value and the gradient at a place both read: of uint8, x − 1 … x + 2 in the four
  /// rows of the cell; of wider voxels nothing, they take other words for each.
  struct Words {
    Ints row[kStorage == Storage::kUInt8 ? 4 : 1];
  };
  HWY_INLINE Words words(const Place& at) const {
    if constexpr (kStorage == Storage::kUInt8) {
      const auto x = part<0>(at.x);
      const auto y = part<1>(at.y), z0 = part<2>(at.z);
      const auto y0 = y + x, y1 = next_part<1>(at.y, y) + x;
      const auto z1 = next_part<2>(at.z, z0);
      return {{word<-1>(y0 + z0), word<-1>(y1 + z0), word<-1>(y0 + z1), word<-1>(y1 + z1)}};
    } else {
      return {{hn::Zero(kInts)}};
    }
  }

  /// Not finite where one of the eight voxels is not.
  HWY_INLINE Floats value(const Place& at, const Words& words) const {
    Floats rows[4];
    if constexpr (kStorage == Storage::kUInt8) {
      for (int i = 0; i < 4; ++i)
        rows[i] = lerp(bits_of<8, 8>(words.row[i]), bits_of<16, 8>(words.row[i]), at.fx);
    } else {
      const auto x = part<0>(at.x);
      const auto y = part<1>(at.y), z0 = part<2>(at.z);
      const auto y0 = y + x, y1 = next_part<1>(at.y, y) + x;
      const auto z1 = next_part<2>(at.z, z0);
      rows[0] = along_x(y0 + z0, at.fx), rows[1] = along_x(y1 + z0, at.fx);
      rows[2] = along_x(y0 + z1, at.fx), rows[3] = along_x(y1 + z1, at.fx);
    }
    return lerp(lerp(rows[0], rows[1], at.fy), lerp(rows[2], rows[3], at.fy), at.fz);
  }
  HWY_INLINE Floats value(const Place& at) const { return value(at, words(at)); }

  /// Central differences at the voxels, interpolated trilinearly, per voxel. Beyond the border the
  /// border's voxel is repeated. Equal voxels give exactly 0.
  HWY_INLINE Floats3 gradient(const Place& at, const Words& words) const {
    const auto x = part<0>(at.x);
    const auto y_part = part<1>(at.y), z = part<2>(at.z);
    const auto y = y_part + x, y_next = next_part<1>(at.y, y_part) + x;
    const auto z_next = next_part<2>(at.z, z);
    const Row r00 = row(word_of(words, 0), y + z, at.fx);
    const Row r10 = row(word_of(words, 1), y_next + z, at.fx);
    const Row r01 = row(word_of(words, 2), y + z_next, at.fx);
    const Row r11 = row(word_of(words, 3), y_next + z_next, at.fx);
    const Floats slope_x =
        lerp(lerp(r00.slope, r10.slope, at.fy), lerp(r01.slope, r11.slope, at.fy), at.fz);

    const auto y_before = part<1>(before(at.y)) + x, y_after = part<1>(after<1>(at.y)) + x;
    const Floats slope_y = lerp(slope(along_x(y_before + z, at.fx), r00.value, r10.value,
                                      along_x(y_after + z, at.fx), at.fy),
                                slope(along_x(y_before + z_next, at.fx), r01.value, r11.value,
                                      along_x(y_after + z_next, at.fx), at.fy),
                                at.fz);

    const auto z_before = part<2>(before(at.z)), z_after = part<2>(after<2>(at.z));
    const Floats slope_z = lerp(slope(along_x(y + z_before, at.fx), r00.value, r01.value,
                                      along_x(y + z_after, at.fx), at.fz),
                                slope(along_x(y_next + z_before, at.fx), r10.value, r11.value,
                                      along_x(y_next + z_after, at.fx), at.fz),
                                at.fy);
    const Floats half = hn::Set(kFloats, 0.5F);
    return {hn::Mul(half, slope_x), hn::Mul(half, slope_y), hn::Mul(half, slope_z)};
  }

 private:
  static constexpr int kBytes =
      kStorage == Storage::kUInt8 ? 1 : (kStorage == Storage::kUInt16 ? 2 : 4);
  /// From one voxel to the next along an axis, inside a brick.
  static constexpr int kLocalBytes[3] = {kBytes, BrickLayout::kRow* kBytes,
                                         BrickLayout::kSlice* kBytes};
  static constexpr int kShift[3] = {BrickLayout::kShiftX, BrickLayout::kShiftY,
                                    BrickLayout::kShiftZ};

  /// Interpolated along x, and twice the interpolated central difference along x.
  struct Row {
    Floats value;
    Floats slope;
  };

  static HWY_INLINE Ints next(Ints i) { return hn::Add(i, hn::Set(kInts, 1)); }
  static HWY_INLINE Ints before(Ints i) {
    return hn::Max(hn::Sub(i, hn::Set(kInts, 1)), hn::Zero(kInts));
  }
  template <int kAxis>
  HWY_INLINE Ints after(Ints i) const {
    return hn::Min(hn::Add(i, hn::Set(kInts, 2)), hn::Set(kInts, layout_.size[kAxis] - 1));
  }

  /// Twice the central difference between four equidistant values, at `fraction` between the inner
  /// two.
  static HWY_INLINE Floats slope(Floats v0, Floats v1, Floats v2, Floats v3, Floats fraction) {
    return lerp(hn::Sub(v2, v0), hn::Sub(v3, v1), fraction);
  }

  template <int kAxis>
  HWY_INLINE auto part(Ints coordinate) const {
    const Ints brick = hn::ShiftRight<kShift[kAxis]>(coordinate);
    const Ints local = hn::Set(kInts, kLocalBytes[kAxis]);
    if constexpr (kAddressing == Addressing::kNarrow) {
      const Ints step = hn::Mul(brick, hn::Set(kInts, layout_.step_bytes[kAxis]));
      return NarrowOffset{hn::Add(hn::Mul(coordinate, local), step)};
    } else {
      const Ints place = hn::And(coordinate, hn::Set(kInts, (1 << kShift[kAxis]) - 1));
      return WideOffset{hn::Mul(brick, hn::Set(kInts, layout_.brick_stride[kAxis])),
                        hn::Mul(place, local)};
    }
  }

  /// part<kAxis>(coordinate + 1), from that of the coordinate.
  template <int kAxis>
  HWY_INLINE NarrowOffset next_part(Ints coordinate, NarrowOffset at) const {
    const Ints last = hn::Set(kInts, (1 << kShift[kAxis]) - 1);
    const auto crosses = hn::Eq(hn::And(coordinate, last), last);
    const Ints step = hn::Set(kInts, layout_.step_bytes[kAxis] + kLocalBytes[kAxis]);
    const Ints inside = hn::Set(kInts, kLocalBytes[kAxis]);
    return {hn::Add(at.bytes, hn::IfThenElse(crosses, step, inside))};
  }
  template <int kAxis>
  HWY_INLINE WideOffset next_part(Ints coordinate, WideOffset) const {
    return part<kAxis>(next(coordinate));
  }

  /// 32 bits that start `elements` voxels right of the row's place.
  template <int kElements>
  HWY_INLINE Ints word(NarrowOffset at) const {
    return gather_bytes(layout_.voxels + (kElements + BrickLayout::kLeft) * kBytes, at.bytes);
  }
  template <int kElements>
  HWY_INLINE Ints word(WideOffset at) const {
    HWY_ALIGN std::int32_t brick[hn::MaxLanes(kInts)];
    HWY_ALIGN std::int32_t bytes[hn::MaxLanes(kInts)];
    hn::Store(at.brick, kInts, brick);
    hn::Store(at.bytes, kInts, bytes);
    const std::uint8_t* base = layout_.voxels + (kElements + BrickLayout::kLeft) * kBytes;
    for (std::size_t i = 0; i < hn::MaxLanes(kInts); ++i)
      std::memcpy(&bytes[i],
                  base + std::int64_t(brick[i]) * BrickLayout::kBrick * kBytes + bytes[i],
                  sizeof(bytes[i]));
    return hn::Load(kInts, bytes);
  }

  template <class Offset>
  HWY_INLINE Floats along_x(Offset at, Floats fraction) const {
    if constexpr (kStorage == Storage::kUInt8) {
      const Ints both = word<0>(at);
      return lerp(bits_of<0, 8>(both), bits_of<8, 8>(both), fraction);
    } else if constexpr (kStorage == Storage::kUInt16) {
      const Ints both = word<0>(at);
      return lerp(bits_of<0, 16>(both), bits_of<16, 16>(both), fraction);
    } else {
      return lerp(hn::BitCast(kFloats, word<0>(at)), hn::BitCast(kFloats, word<1>(at)), fraction);
    }
  }

  static HWY_INLINE Ints word_of(const Words& words, int i) {
    return words.row[kStorage == Storage::kUInt8 ? i : 0];
  }

  /// `four` is the row's word of uint8 voxels, taken before.
  template <class Offset>
  HWY_INLINE Row row(Ints four, Offset at, Floats fraction) const {
    Floats v0, v1, v2, v3;
    if constexpr (kStorage == Storage::kUInt8) {
      v0 = bits_of<0, 8>(four), v1 = bits_of<8, 8>(four);
      v2 = bits_of<16, 8>(four), v3 = bits_of<24, 8>(four);
    } else if constexpr (kStorage == Storage::kUInt16) {
      const Ints left = word<-1>(at), right = word<1>(at);
      v0 = bits_of<0, 16>(left), v1 = bits_of<16, 16>(left);
      v2 = bits_of<0, 16>(right), v3 = bits_of<16, 16>(right);
    } else {
      v0 = hn::BitCast(kFloats, word<-1>(at)), v1 = hn::BitCast(kFloats, word<0>(at));
      v2 = hn::BitCast(kFloats, word<1>(at)), v3 = hn::BitCast(kFloats, word<2>(at));
    }
    return {lerp(v1, v2, fraction), slope(v0, v1, v2, v3, fraction)};
  }

  const FieldLayout& layout_;
};

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
