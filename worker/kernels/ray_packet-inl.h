// SPDX-License-Identifier: Apache-2.0
// One ray per lane. A ray is set up in double precision, so that a far camera costs no digits, and
// handed on in float relative to the start of its first segment. Segments [k·h, (k+1)·h] are
// measured from the camera: the same for every tile, slab and rank.

#if defined(GOLDTHREAD_WORKER_KERNELS_RAY_PACKET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_RAY_PACKET_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_RAY_PACKET_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_RAY_PACKET_INL_H_
#endif

#include <algorithm>
#include <limits>

#include "worker/kernels/kernel_types.h"
#include "worker/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

constexpr std::size_t kLanes = hn::MaxLanes(FloatTag());

/// A packet of rays. Lengths along a ray are in steps from the start of its first segment.
struct alignas(64) RayColumns {
  float start[3][kLanes];       ///< voxel index where the first segment begins, maybe outside
  float direction[3][kLanes];   ///< voxel indices per step
  float first[kLanes];          ///< where the volume begins, in [0, 1]
  float last[kLanes];           ///< where the volume ends, in (segments − 1, segments]
  float segments[kLanes];       ///< 0: the volume is missed
  float start_rest[3][kLanes];  ///< what rounding took from start and direction
  float direction_rest[3][kLanes];
  float delay[kLanes];  ///< first segment's number, less the least one in the packet
};

#if HWY_TARGET == HWY_SCALAR
using DoubleTag = hn::Sisd<double>;
#else
using DoubleTag = hn::ScalableTag<double>;
#endif
using Doubles = hn::Vec<DoubleTag>;
constexpr DoubleTag kDoubles{};

/// The part of a ray inside [0, extent] of each axis; empty unless exit > entry.
struct Span {
  Doubles entry;
  Doubles exit;
};

/// A component of 0 makes 0·∞ in the usual slab test: such an axis decides all or nothing. The
/// faces belong to the volume.
HWY_INLINE Span clip(const double* origin, const Doubles (&direction)[3], const float* upper) {
  const Doubles infinite = hn::Set(kDoubles, std::numeric_limits<double>::infinity());
  Span span{hn::Zero(kDoubles), infinite};
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = std::ceil(double(upper[axis]));
    const auto along = hn::Lt(hn::Abs(direction[axis]), hn::Set(kDoubles, 1e-30));
    const Doubles divisor = hn::IfThenElse(along, hn::Set(kDoubles, 1.0), direction[axis]);
    const Doubles inverse = hn::Div(hn::Set(kDoubles, 1.0), divisor);
    const Doubles to_low = hn::Mul(hn::Set(kDoubles, -origin[axis]), inverse);
    const Doubles to_high = hn::Mul(hn::Set(kDoubles, extent - origin[axis]), inverse);
    const bool inside = origin[axis] >= 0 && origin[axis] <= extent;
    const Doubles nothing = inside ? infinite : hn::Set(kDoubles, -1.0);
    const Doubles entry = hn::IfThenElseZero(hn::Not(along), hn::Min(to_low, to_high));
    const Doubles exit = hn::IfThenElse(along, nothing, hn::Max(to_low, to_high));
    span.entry = hn::Max(span.entry, entry);
    span.exit = hn::Min(span.exit, exit);
  }
  return span;
}

/// As many floats as doubles fit into a vector.
HWY_INLINE void store_as_floats(Doubles v, float* to) {
  const hn::Rebind<float, DoubleTag> floats;
  hn::StoreU(hn::DemoteTo(floats, v), floats, to);
}

HWY_INLINE void store_with_rest(Doubles v, float* to, float* rest) {
  const hn::Rebind<float, DoubleTag> floats;
  const auto rounded = hn::DemoteTo(floats, v);
  hn::StoreU(rounded, floats, to);
  store_as_floats(hn::Sub(v, hn::PromoteTo(kDoubles, rounded)), rest);
}

/// Rays through `count` ≤ kLanes positions; the others miss. Returns whether any ray hits.
HWY_INLINE bool set_up_rays(const KernelScene& scene, const KernelView& view,
                            const PixelPosition* positions, std::size_t count, RayColumns& rays) {
  constexpr std::size_t kWidth = hn::MaxLanes(DoubleTag());
  HWY_ALIGN double x[kLanes], y[kLanes], number[kLanes];
  HWY_ALIGN double wanted[kLanes];
  for (std::size_t i = 0; i < kLanes; ++i) {
    const PixelPosition position = positions[i < count ? i : 0];
    x[i] = double(position.x);
    y[i] = double(position.y);
    wanted[i] = i < count ? 1 : 0;
  }
  const Doubles one = hn::Set(kDoubles, 1.0);
  const Doubles per_step = hn::Set(kDoubles, 1 / scene.step_mm);
  const Doubles step = hn::Set(kDoubles, scene.step_mm);
  bool any = false;
  for (std::size_t i = 0; i < kLanes; i += kWidth) {
    const Doubles scale = hn::Set(kDoubles, view.scale);
    const Doubles u =
        hn::Mul(hn::Sub(hn::Load(kDoubles, x + i), hn::Set(kDoubles, view.centre_x)), scale);
    const Doubles v =
        hn::Mul(hn::Sub(hn::Set(kDoubles, view.centre_y), hn::Load(kDoubles, y + i)), scale);
    const Doubles length = hn::Sqrt(hn::MulAdd(u, u, hn::MulAdd(v, v, one)));
    Doubles direction[3];
    for (int axis = 0; axis < 3; ++axis)
      direction[axis] = hn::Div(hn::MulAdd(u, hn::Set(kDoubles, view.right[axis]),
                                           hn::MulAdd(v, hn::Set(kDoubles, view.up[axis]),
                                                      hn::Set(kDoubles, view.forward[axis]))),
                                length);
    const Span span = clip(view.origin, direction, scene.field.upper);
    const auto hit = hn::And(hn::Gt(span.exit, span.entry),
                             hn::Gt(hn::Load(kDoubles, wanted + i), hn::Zero(kDoubles)));
    any = any || !hn::AllFalse(kDoubles, hit);
    const Doubles entry = hn::IfThenElseZero(hit, hn::Mul(span.entry, per_step));
    const Doubles exit = hn::IfThenElseZero(hit, hn::Mul(span.exit, per_step));
    const Doubles first = hn::Floor(entry);
    store_as_floats(hn::Sub(entry, first), rays.first + i);
    store_as_floats(hn::Sub(exit, first), rays.last + i);
    store_as_floats(hn::Sub(hn::Ceil(exit), first), rays.segments + i);
    hn::Store(hn::IfThenElse(hit, first, hn::Set(kDoubles, 1e300)), kDoubles, number + i);
    for (int axis = 0; axis < 3; ++axis) {
      const Doubles way = hn::Mul(direction[axis], step);
      const Doubles start = hn::MulAdd(first, way, hn::Set(kDoubles, view.origin[axis]));
      store_with_rest(hn::IfThenElseZero(hit, start), rays.start[axis] + i,
                      rays.start_rest[axis] + i);
      store_with_rest(hn::IfThenElseZero(hit, way), rays.direction[axis] + i,
                      rays.direction_rest[axis] + i);
    }
  }
  const double least = *std::min_element(number, number + kLanes);
  for (std::size_t i = 0; i < kLanes; ++i)
    rays.delay[i] = rays.segments[i] > 0 ? float(number[i] - least) : 0.0F;
  return any;
}

struct Rays {
  Floats3 start, direction;
  Floats first, last, segments, delay;

  HWY_INLINE explicit Rays(const RayColumns& rays)
      : start{hn::Load(kFloats, rays.start[0]), hn::Load(kFloats, rays.start[1]),
              hn::Load(kFloats, rays.start[2])},
        direction{hn::Load(kFloats, rays.direction[0]), hn::Load(kFloats, rays.direction[1]),
                  hn::Load(kFloats, rays.direction[2])},
        first(hn::Load(kFloats, rays.first)),
        last(hn::Load(kFloats, rays.last)),
        segments(hn::Load(kFloats, rays.segments)),
        delay(hn::Load(kFloats, rays.delay)) {}

  /// The position after `steps`, never by adding up; rounding is kept from leaving the volume.
  HWY_INLINE Floats3 at(Floats steps, const float* upper) const {
    const auto inside = [&](Floats v, float limit) HWY_ATTR {
      return hn::Min(hn::Max(v, hn::Zero(kFloats)), hn::Set(kFloats, limit));
    };
    return {inside(hn::MulAdd(steps, direction.x, start.x), upper[0]),
            inside(hn::MulAdd(steps, direction.y, start.y), upper[1]),
            inside(hn::MulAdd(steps, direction.z, start.z), upper[2])};
  }
};

/// What is needed to place a ray in a cell to the last digit.
struct FineRays {
  Floats3 start_rest, direction_rest;

  HWY_INLINE explicit FineRays(const RayColumns& rays)
      : start_rest{hn::Load(kFloats, rays.start_rest[0]), hn::Load(kFloats, rays.start_rest[1]),
                   hn::Load(kFloats, rays.start_rest[2])},
        direction_rest{hn::Load(kFloats, rays.direction_rest[0]),
                       hn::Load(kFloats, rays.direction_rest[1]),
                       hn::Load(kFloats, rays.direction_rest[2])} {}

  /// The position after `steps` as seen from the lower corner of `cell`.
  HWY_INLINE Floats3 inside(const Rays& rays, const Floats3& cell, Floats steps) const {
    const auto along = [&](Floats c, Floats start, Floats direction, Floats rest, Floats slope_rest)
                           HWY_ATTR {
                             const Floats coarse = hn::MulAdd(steps, direction, hn::Sub(start, c));
                             return hn::Add(coarse, hn::MulAdd(steps, slope_rest, rest));
                           };
    return {along(cell.x, rays.start.x, rays.direction.x, start_rest.x, direction_rest.x),
            along(cell.y, rays.start.y, rays.direction.y, start_rest.y, direction_rest.y),
            along(cell.z, rays.start.z, rays.direction.z, start_rest.z, direction_rest.z)};
  }
};

/// Segment `index` of each ray, clipped to the volume, in steps.
struct Segment {
  Floats begin, end;
};
HWY_INLINE Segment segment_of(const Rays& rays, Floats index) {
  const Floats begin = hn::Max(index, rays.first);
  const Floats end = hn::Min(hn::Add(index, hn::Set(kFloats, 1.0F)), rays.last);
  return {begin, hn::Max(end, begin)};
}
HWY_INLINE Floats middle(Floats begin, Floats end) {
  return hn::Mul(hn::Set(kFloats, 0.5F), hn::Add(begin, end));
}

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
