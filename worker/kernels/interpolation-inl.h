// SPDX-License-Identifier: Apache-2.0
// Trilinear values and gradients at a place per lane, from the bytes of voxels, whoever brings
// them: a window or the lanes' own loads.

#if defined(GOLDTHREAD_WORKER_KERNELS_INTERPOLATION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_INTERPOLATION_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_INTERPOLATION_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_INTERPOLATION_INL_H_
#endif

#include "worker/kernels/kernel_table.h"
#include "worker/kernels/lone_voxels-inl.h"
#include "worker/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

/// A place inside a cell of 2³ voxels.
struct CellPlace {
  Ints3 at;           ///< of the cell's lower corner
  Floats fx, fy, fz;  ///< from there, in [0, 1)
};

HWY_INLINE CellPlace locate(const Floats3& position) {
  const Ints x = truncated(position.x);
  const Ints y = truncated(position.y);
  const Ints z = truncated(position.z);
  return {{x, y, z},
          hn::Sub(position.x, hn::ConvertTo(kFloats, x)),
          hn::Sub(position.y, hn::ConvertTo(kFloats, y)),
          hn::Sub(position.z, hn::ConvertTo(kFloats, z))};
}

template <Storage kStorage>
class Interpolation {
 public:
  static constexpr int kPlanes =
      kStorage == Storage::kUInt8 ? 1 : (kStorage == Storage::kUInt16 ? 2 : 4);

  // Not left to the compiler: its own would lack the target's instructions.
  HWY_INLINE Interpolation() : byte_mask_(hn::Set(kInts, unknown(255))) {}

  /// The eight voxels around `place`, x fastest, then y, then z.
  template <class Source>
  HWY_INLINE void corners(const Source& source, const CellPlace& place, FloatMask lanes,
                          Floats (&numbers)[8]) const {
    Bytes bytes[kPlanes][2];
    GOLDTHREAD_UNROLL
    for (int plane = 0; plane < kPlanes; ++plane)
      source.take_cell(place.at, lanes, plane, bytes[plane]);
    numbers_of(bytes, numbers);
  }

  template <class Source>
  HWY_INLINE Floats value(const Source& source, const CellPlace& place, FloatMask lanes) const {
    Floats found[8];
    corners(source, place, lanes, found);
    return trilinear(found, place);
  }

  /// Central differences at the voxels, interpolated trilinearly, per voxel.
  template <class Source>
  HWY_INLINE Floats3 gradient(const Source& source, const CellPlace& place, FloatMask lanes) const {
    Bytes bytes[kPlanes][8];
    GOLDTHREAD_UNROLL
    for (int plane = 0; plane < kPlanes; ++plane)
      source.take_around(place.at, lanes, plane, bytes[plane]);
    Floats numbers[32];
    numbers_of(bytes, numbers);
    // The cell and what lies before and behind it along each axis: [slice][y][x].
    const Floats *core = numbers, *beside_x = numbers + 16, *beside_y = numbers + 24;
    const Floats fx = place.fx, fy = place.fy, fz = place.fz;
    Floats slope_x[4], slope_y[4], slope_z[4];
    for (int z = 0; z < 2; ++z) {
      const Floats* cell = core + 4 * (z + 1);
      for (int y = 0; y < 2; ++y)
        slope_x[2 * z + y] = slope(beside_x[4 * z + 2 * y], cell[2 * y], cell[2 * y + 1],
                                   beside_x[4 * z + 2 * y + 1], fx);
      for (int x = 0; x < 2; ++x)
        slope_y[2 * z + x] =
            slope(beside_y[4 * z + x], cell[x], cell[2 + x], beside_y[4 * z + 2 + x], fy);
    }
    for (int i = 0; i < 4; ++i)
      slope_z[i] = slope(core[i], core[4 + i], core[8 + i], core[12 + i], fz);
    const auto bilinear = [&](const Floats(&v)[4], Floats f, Floats g) HWY_ATTR {
      return hn::Mul(hn::Set(kFloats, 0.5F), lerp(lerp(v[0], v[1], f), lerp(v[2], v[3], f), g));
    };
    return {bilinear(slope_x, fy, fz), bilinear(slope_y, fx, fz), bilinear(slope_z, fx, fy)};
  }

 private:
  /// Byte kByte of each lane, shifted to byte kTo, the rest 0.
  template <int kByte, int kTo>
  HWY_INLINE Ints move_byte(Bytes four) const {
    const auto word = hn::BitCast(kUnsigned, four);
    if constexpr (kByte == 3) {
      const auto alone = hn::ShiftRight<24>(word);
      return hn::BitCast(kInts, hn::ShiftLeft<8 * kTo>(alone));
    } else {
      const Ints alone = hn::And(hn::BitCast(kInts, hn::ShiftRight<8 * kByte>(word)), byte_mask_);
      return hn::ShiftLeft<8 * kTo>(alone);
    }
  }

  /// Voxel kByte of each lane as a number, from its bytes in the planes.
  template <int kByte>
  HWY_INLINE Floats number(const Bytes (&planes)[kPlanes]) const {
    if constexpr (kStorage == Storage::kUInt8) {
      return hn::ConvertTo(kFloats, move_byte<kByte, 0>(planes[0]));
    } else if constexpr (kStorage == Storage::kUInt16) {
      return hn::ConvertTo(kFloats,
                           hn::Or(move_byte<kByte, 0>(planes[0]), move_byte<kByte, 1>(planes[1])));
    } else {
      const Ints low = hn::Or(move_byte<kByte, 0>(planes[0]), move_byte<kByte, 1>(planes[1]));
      const Ints high = hn::Or(move_byte<kByte, 2>(planes[2]), move_byte<kByte, 3>(planes[3]));
      return hn::BitCast(kFloats, hn::Or(low, high));
    }
  }

  /// Slices of four voxels a lane, plane by plane, as numbers.
  template <int kSlices, int kNumbers>
  HWY_INLINE void numbers_of(const Bytes (&bytes)[kPlanes][kSlices],
                             Floats (&numbers)[kNumbers]) const {
    static_assert(kNumbers == 4 * kSlices);
    GOLDTHREAD_UNROLL
    for (int i = 0; i < kSlices; ++i) {
      Bytes of_slice[kPlanes];
      for (int plane = 0; plane < kPlanes; ++plane) of_slice[plane] = bytes[plane][i];
      numbers[4 * i] = number<0>(of_slice);
      numbers[4 * i + 1] = number<1>(of_slice);
      numbers[4 * i + 2] = number<2>(of_slice);
      numbers[4 * i + 3] = number<3>(of_slice);
    }
  }

  static HWY_INLINE Floats trilinear(const Floats (&corners)[8], const CellPlace& place) {
    const Floats near = lerp(lerp(corners[0], corners[1], place.fx),
                             lerp(corners[2], corners[3], place.fx), place.fy);
    const Floats far = lerp(lerp(corners[4], corners[5], place.fx),
                            lerp(corners[6], corners[7], place.fx), place.fy);
    return lerp(near, far, place.fz);
  }

  /// Twice the central difference between four equidistant values, at `fraction` between the inner
  /// two.
  static HWY_INLINE Floats slope(Floats v0, Floats v1, Floats v2, Floats v3, Floats fraction) {
    return lerp(hn::Sub(v2, v0), hn::Sub(v3, v1), fraction);
  }

  Ints byte_mask_;
};

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
