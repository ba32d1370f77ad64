// SPDX-License-Identifier: Apache-2.0
// The scalar field: trilinear values and gradients at a position per lane, from windows of voxels.
// Positions are voxel indices inside [0, upper].

#if defined(GOLDTHREAD_WORKER_KERNELS_FIELD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_FIELD_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_FIELD_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_FIELD_INL_H_
#endif

#include "worker/kernels/interpolation-inl.h"
#include "worker/kernels/lone_voxels-inl.h"
#include "worker/kernels/window-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

// What rays too far apart for a window need has functions of its own, which are not inlined: the
// registers belong to the usual case.

template <Storage kStorage>
HWY_NOINLINE void lone_corners(const FieldLayout& layout, const CellPlace& place, FloatMask lanes,
                               Floats (&corners)[8]) {
  Interpolation<kStorage>().corners(LoneVoxels(layout), place, lanes, corners);
}

template <Storage kStorage>
HWY_NOINLINE Floats lone_value(const FieldLayout& layout, const CellPlace& place, FloatMask lanes) {
  return Interpolation<kStorage>().value(LoneVoxels(layout), place, lanes);
}

template <Storage kStorage>
HWY_NOINLINE Floats3 lone_gradient(const FieldLayout& layout, const CellPlace& place,
                                   FloatMask lanes) {
  return Interpolation<kStorage>().gradient(LoneVoxels(layout), place, lanes);
}

template <Storage kStorage, int kCount>
HWY_NOINLINE void lone_values(const FieldLayout& layout, const CellPlace (&places)[kCount],
                              const Ints3& ahead, FloatMask lanes, Floats (&results)[kCount]) {
  const LoneVoxels voxels(layout);
  const Interpolation<kStorage> between;
  for (int plane = 0; plane < between.kPlanes; ++plane) voxels.fetch_ahead(ahead, lanes, plane);
  GOLDTHREAD_UNROLL
  for (int i = 0; i < kCount; ++i) results[i] = between.value(voxels, places[i], lanes);
}

/// kGradients: whether gradients will be asked for.
template <Storage kStorage, bool kGradients>
class Field {
 public:
  /// Integers are always finite.
  static constexpr bool kMayBeInfinite = kStorage == Storage::kFloat32;

  HWY_INLINE explicit Field(const FieldLayout& layout)
      : layout_(layout), window_(layout), wide_window_(layout) {}

  // The usual case, all lanes in one window, must not depend on which lanes these are: they follow
  // from the sample before, and the next one could not be begun before that is known.

  /// The values at `place` of `lanes`, unspecified of the others. Not finite where one of the
  /// eight voxels is not.
  HWY_INLINE Floats value(const CellPlace& place, FloatMask lanes) {
    if (window_.reaches(place.at, lanes)) return between_.value(window_, place, lanes);
    return lone_value<kStorage>(layout_, place, lanes);
  }

#if HWY_TARGET != HWY_SCALAR
  static constexpr auto& kBeamEdges = Window<0>::kBeamEdges;
  static constexpr auto& kMostEdges = Window<0>::kMostEdges;

  /// The values at the middles of kCount segments from `first` on, of a beam that is narrow there.
  template <int kCount>
  HWY_INLINE void values(const Beam& beam, float first, const CellPlace (&places)[kCount],
                         FloatMask lanes, Floats (&results)[kCount]) {
    window_.lie(beam, first, first + float(kCount - 1));
    GOLDTHREAD_UNROLL
    for (int i = 0; i < kCount; ++i) results[i] = between_.value(window_, places[i], lanes);
  }

  /// The values of rays so far apart that to try a window is in vain; they will soon be at `ahead`.
  template <int kCount>
  HWY_INLINE void values_apart(const CellPlace (&places)[kCount], const CellPlace& ahead,
                               FloatMask lanes, Floats (&results)[kCount]) {
    lone_values<kStorage, kCount>(layout_, places, ahead.at, lanes, results);
  }
#endif

  /// The eight voxels around `place`, x fastest, then y, then z.
  HWY_INLINE void cell(const CellPlace& place, FloatMask lanes, Floats (&corners)[8]) {
    if (window_.reaches(place.at, lanes)) {
      between_.corners(window_, place, lanes, corners);
    } else {
      lone_corners<kStorage>(layout_, place, lanes, corners);
    }
  }

  /// Central differences at the voxels, interpolated trilinearly, per voxel. Beyond the border the
  /// border's voxel is repeated. Equal voxels give exactly 0.
  HWY_INLINE Floats3 gradient(const CellPlace& place, FloatMask lanes) {
    static_assert(kGradients);
    if (wide_window_.reaches(place.at, lanes)) return between_.gradient(wide_window_, place, lanes);
    if constexpr (!LoneVoxels::kIsQuick) {
      const FloatMask near = wide_window_.reached(place.at, lanes);
      if (2 * hn::CountTrue(kFloats, near) >= hn::CountTrue(kFloats, lanes))
        return gradient_of_most(place, near, lanes);
    }
    return lone_gradient<kStorage>(layout_, place, lanes);
  }

  /// Where a value is finite; the others become 0.
  static HWY_INLINE FloatMask take_finite(Floats& value) {
    if constexpr (!kMayBeInfinite) return hn::Eq(hn::Zero(kFloats), hn::Zero(kFloats));
    const FloatMask finite = is_finite(value);
    value = hn::IfThenElseZero(finite, value);
    return finite;
  }

 private:
  /// The window holds those that are `near`.
  HWY_INLINE Floats3 gradient_of_most(const CellPlace& place, FloatMask near, FloatMask lanes) {
    const Floats3 a = between_.gradient(wide_window_, place, near);
    const Floats3 b = lone_gradient<kStorage>(layout_, place, hn::AndNot(near, lanes));
    return {hn::IfThenElse(near, a.x, b.x), hn::IfThenElse(near, a.y, b.y),
            hn::IfThenElse(near, a.z, b.z)};
  }

  const FieldLayout& layout_;
  Window<0> window_;
  Window<1> wide_window_;  ///< for gradients
  Interpolation<kStorage> between_;
};

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
