// SPDX-License-Identifier: Apache-2.0
// The scalar field: trilinear values and gradients at a position per lane, from windows of voxels.
// Positions are voxel indices inside [0, upper].

#if defined(GOLDTHREAD_WORKER_KERNELS_FIELD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_FIELD_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_FIELD_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_FIELD_INL_H_
#endif

#include "worker/kernels/kernel_table.h"
#include "worker/kernels/vector_math-inl.h"
#include "worker/kernels/window-inl.h"

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

/// kGradients: whether gradients will be asked for.
template <Storage kStorage, bool kGradients>
class Field {
 public:
  /// Integers are always finite.
  static constexpr bool kMayBeInfinite = kStorage == Storage::kFloat32;

  HWY_INLINE explicit Field(const FieldLayout& layout)
      : window_(layout), wide_window_(layout), byte_mask_(hn::Set(kInts, unknown(255))) {}

  // The usual case, all lanes in one window, must not depend on which lanes these are: they follow
  // from the sample before, and the next one could not be begun before that is known.

  /// The values at `place` of `lanes`, unspecified of the others. Not finite where one of the
  /// eight voxels is not.
  HWY_INLINE Floats value(const CellPlace& place, FloatMask lanes) {
    if (window_.reaches(place.at, lanes)) return value_in_window(place, lanes);
    Floats result = hn::Zero(kFloats);
    window_.cover(place.at, lanes, [&](FloatMask covered) HWY_ATTR {
      result = hn::IfThenElse(covered, value_in_window(place, covered), result);
    });
    return result;
  }

#if HWY_TARGET != HWY_SCALAR
  static constexpr auto& kBeamEdges = Window<0>::kBeamEdges;

  /// The values at the middles of kCount segments from `first` on, of a beam that is narrow there.
  template <int kCount>
  HWY_INLINE void values(const Beam& beam, float first, const CellPlace (&places)[kCount],
                         FloatMask lanes, Floats (&results)[kCount]) {
    window_.lie(beam, first, first + float(kCount - 1));
    GOLDTHREAD_UNROLL
    for (int i = 0; i < kCount; ++i) results[i] = value_in_window(places[i], lanes);
  }
#endif

  /// The eight voxels around `place`, x fastest, then y, then z.
  HWY_INLINE void cell(const CellPlace& place, FloatMask lanes, Floats (&corners)[8]) {
    if (window_.reaches(place.at, lanes)) {
      this->template corners<0, 1, 0, 1, 0, 2>(window_, window_.place(place.at), lanes, corners);
      return;
    }
    for (Floats& corner : corners) corner = hn::Zero(kFloats);
    window_.cover(place.at, lanes, [&](FloatMask covered) HWY_ATTR {
      Floats found[8];
      this->template corners<0, 1, 0, 1, 0, 2>(window_, window_.place(place.at), covered, found);
      for (int i = 0; i < 8; ++i) corners[i] = hn::IfThenElse(covered, found[i], corners[i]);
    });
  }

  /// Central differences at the voxels, interpolated trilinearly, per voxel. Beyond the border the
  /// border's voxel is repeated. Equal voxels give exactly 0.
  HWY_INLINE Floats3 gradient(const CellPlace& place, FloatMask lanes) {
    static_assert(kGradients);
    if (wide_window_.reaches(place.at, lanes)) return gradient_in_window(place, lanes);
    Floats3 result{hn::Zero(kFloats), hn::Zero(kFloats), hn::Zero(kFloats)};
    wide_window_.cover(place.at, lanes, [&](FloatMask covered) HWY_ATTR {
      const Floats3 found = gradient_in_window(place, covered);
      result = {hn::IfThenElse(covered, found.x, result.x),
                hn::IfThenElse(covered, found.y, result.y),
                hn::IfThenElse(covered, found.z, result.z)};
    });
    return result;
  }

  /// Where a value is finite; the others become 0.
  static HWY_INLINE FloatMask take_finite(Floats& value) {
    if constexpr (!kMayBeInfinite) return hn::Eq(hn::Zero(kFloats), hn::Zero(kFloats));
    const FloatMask finite = is_finite(value);
    value = hn::IfThenElseZero(finite, value);
    return finite;
  }

  static HWY_INLINE Floats trilinear(const Floats (&corners)[8], const CellPlace& place) {
    const Floats near = lerp(lerp(corners[0], corners[1], place.fx),
                             lerp(corners[2], corners[3], place.fx), place.fy);
    const Floats far = lerp(lerp(corners[4], corners[5], place.fx),
                            lerp(corners[6], corners[7], place.fx), place.fy);
    return lerp(near, far, place.fz);
  }

 private:
  static constexpr int kPlanes =
      kStorage == Storage::kUInt8 ? 1 : (kStorage == Storage::kUInt16 ? 2 : 4);

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

  /// Of kCount slices the four voxels of Window::take(), as numbers.
  template <int kX0, int kX1, int kY0, int kY1, int kFirstZ, int kCount, class AnyWindow>
  HWY_INLINE void corners(const AnyWindow& window, const typename AnyWindow::Place& place,
                          FloatMask lanes, Floats (&numbers)[4 * kCount]) const {
    Bytes bytes[kPlanes][kCount];
    GOLDTHREAD_UNROLL
    for (int plane = 0; plane < kPlanes; ++plane)
      window.template take<kX0, kX1, kY0, kY1, kFirstZ, kCount>(place, lanes, plane, bytes[plane]);
    GOLDTHREAD_UNROLL
    for (int i = 0; i < kCount; ++i) {
      Bytes of_slice[kPlanes];
      for (int plane = 0; plane < kPlanes; ++plane) of_slice[plane] = bytes[plane][i];
      numbers[4 * i] = number<0>(of_slice);
      numbers[4 * i + 1] = number<1>(of_slice);
      numbers[4 * i + 2] = number<2>(of_slice);
      numbers[4 * i + 3] = number<3>(of_slice);
    }
  }

  HWY_INLINE Floats value_in_window(const CellPlace& place, FloatMask lanes) const {
    Floats found[8];
    this->template corners<0, 1, 0, 1, 0, 2>(window_, window_.place(place.at), lanes, found);
    return trilinear(found, place);
  }

  /// Twice the central difference between four equidistant values, at `fraction` between the inner
  /// two.
  static HWY_INLINE Floats slope(Floats v0, Floats v1, Floats v2, Floats v3, Floats fraction) {
    return lerp(hn::Sub(v2, v0), hn::Sub(v3, v1), fraction);
  }

  HWY_INLINE Floats3 gradient_in_window(const CellPlace& place, FloatMask lanes) const {
    const auto in_window = wide_window_.place(place.at);
    const Floats fx = place.fx, fy = place.fy, fz = place.fz;
    // The cell and what lies before and behind it along each axis: [slice][y][x].
    Floats core[16], beside_x[8], beside_y[8];
    this->template corners<0, 1, 0, 1, -1, 4>(wide_window_, in_window, lanes, core);
    this->template corners<-1, 2, 0, 1, 0, 2>(wide_window_, in_window, lanes, beside_x);
    this->template corners<0, 1, -1, 2, 0, 2>(wide_window_, in_window, lanes, beside_y);
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

  Window<0> window_;
  Window<1> wide_window_;  ///< for gradients
  Ints byte_mask_;
};

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
