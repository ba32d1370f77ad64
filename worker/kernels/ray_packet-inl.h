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
#include <cmath>
#include <limits>

#include "worker/kernels/kernel_types.h"
#include "worker/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

constexpr std::size_t kLanes = hn::MaxLanes(FloatTag());

/// Rays that are set up together.
constexpr std::size_t kBatchRays = 512;
static_assert(kBatchRays % kLanes == 0);

/// Rays as arrays. Lengths along a ray are in steps from the start of its first segment.
template <std::size_t kCount>
struct alignas(64) RayColumns {
  float start[3][kCount];      ///< voxel index where the first segment begins, maybe outside
  float direction[3][kCount];  ///< voxel indices per step
  float first[kCount];         ///< where the volume begins, in [0, 1]
  float last[kCount];          ///< where the volume ends, in (segments − 1, segments]
  float segments[kCount];      ///< 0: the volume is missed
};
using RayBatch = RayColumns<kBatchRays>;
using RayLanes = RayColumns<kLanes>;

/// Copies one ray.
template <std::size_t kFrom, std::size_t kTo>
HWY_INLINE void copy_ray(const RayColumns<kFrom>& from, std::size_t i, RayColumns<kTo>& to,
                         std::size_t lane) {
  for (int axis = 0; axis < 3; ++axis) {
    to.start[axis][lane] = from.start[axis][i];
    to.direction[axis][lane] = from.direction[axis][i];
  }
  to.first[lane] = from.first[i];
  to.last[lane] = from.last[i];
  to.segments[lane] = from.segments[i];
}

/// The part of a ray inside [0, extent] of each axis; empty unless exit > entry.
struct Span {
  double entry;
  double exit;
};

/// A component of 0 makes 0·∞ in the usual slab test: such an axis decides all or nothing. The
/// faces belong to the volume.
HWY_INLINE Span clip(const double* origin, const double* direction, const float* upper) {
  Span span{0, std::numeric_limits<double>::infinity()};
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = std::ceil(double(upper[axis]));
    const double inverse = 1 / direction[axis];
    const double to_low = -origin[axis] * inverse;
    const double to_high = (extent - origin[axis]) * inverse;
    const bool along = std::abs(direction[axis]) < 1e-30;
    const bool inside = origin[axis] >= 0 && origin[axis] <= extent;
    const double nothing = inside ? span.exit : -1.0;
    const double entry = along ? span.entry : (to_low < to_high ? to_low : to_high);
    const double exit = along ? nothing : (to_low < to_high ? to_high : to_low);
    span.entry = entry > span.entry ? entry : span.entry;
    span.exit = exit < span.exit ? exit : span.exit;
  }
  return span;
}

/// Rays through `count` ≤ kBatchRays positions; up to the next whole packet, the others miss.
HWY_INLINE void set_up_rays(const KernelScene& scene, const KernelView& view,
                            const PixelPosition* positions, std::size_t count, RayBatch& rays) {
  const std::size_t padded = (count + kLanes - 1) / kLanes * kLanes;
  for (std::size_t i = 0; i < padded; ++i) {
    const PixelPosition position = positions[i < count ? i : 0];
    const double u = (double(position.x) - view.centre_x) * view.scale;
    const double v = (view.centre_y - double(position.y)) * view.scale;
    const double inverse_length = 1 / std::sqrt(1 + u * u + v * v);
    double direction[3];
    for (int axis = 0; axis < 3; ++axis)
      direction[axis] =
          (view.forward[axis] + u * view.right[axis] + v * view.up[axis]) * inverse_length;
    const Span span = clip(view.origin, direction, scene.field.upper);
    const bool hit = i < count && span.exit > span.entry;
    const double entry = hit ? span.entry / scene.step_mm : 0;
    const double exit = hit ? span.exit / scene.step_mm : 0;
    const double origin = std::floor(entry);
    rays.first[i] = float(entry - origin);
    rays.last[i] = float(exit - origin);
    rays.segments[i] = float(std::ceil(exit) - origin);
    for (int axis = 0; axis < 3; ++axis) {
      const double per_step = direction[axis] * scene.step_mm;
      rays.start[axis][i] = hit ? float(view.origin[axis] + origin * per_step) : 0.0F;
      rays.direction[axis][i] = hit ? float(per_step) : 0.0F;
    }
  }
}

struct Rays {
  Floats3 start, direction;
  Floats first, last, segments;

  /// Those that start at `begin`, a multiple of kLanes.
  template <std::size_t kCount>
  HWY_INLINE Rays(const RayColumns<kCount>& rays, std::size_t begin)
      : start{hn::Load(kFloats, rays.start[0] + begin), hn::Load(kFloats, rays.start[1] + begin),
              hn::Load(kFloats, rays.start[2] + begin)},
        direction{hn::Load(kFloats, rays.direction[0] + begin),
                  hn::Load(kFloats, rays.direction[1] + begin),
                  hn::Load(kFloats, rays.direction[2] + begin)},
        first(hn::Load(kFloats, rays.first + begin)),
        last(hn::Load(kFloats, rays.last + begin)),
        segments(hn::Load(kFloats, rays.segments + begin)) {}

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
