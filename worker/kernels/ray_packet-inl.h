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
  float begin[kLanes];          ///< the first segment in the slab
  float segments[kLanes];       ///< the one after the last in the slab; begin: it is missed
  float until[kLanes];          ///< where the ray leaves the slab; far where it leaves the volume
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
HWY_INLINE Span clip(const double* origin, const Doubles (&direction)[3],
                     const std::int32_t* size) {
  const Doubles infinite = hn::Set(kDoubles, std::numeric_limits<double>::infinity());
  Span span{hn::Zero(kDoubles), infinite};
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = double(size[axis] - 1);
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

/// A ray's segments in doubles, in steps from the camera, and where it runs along z, in voxels.
struct RaySegments {
  double entry, exit;  ///< of the volume
  double first;        ///< number of the first segment
  double count;
  double start_z, way_z;

  double middle_z(double index) const {
    const double begin = std::max(first + index, entry), end = std::min(first + index + 1, exit);
    return start_z + 0.5 * (begin + end) * way_z;
  }
  /// The first segment, or else `count`, whose middle has reached z on the way.
  double first_beyond(double z) const {
    const auto is_beyond = [&](double index) {
      return way_z > 0 ? middle_z(index) >= z : middle_z(index) < z;
    };
    const double guess = std::ceil((z - start_z) / way_z - first - 0.5);
    double index = guess >= 0 && guess <= count ? guess : guess < 0 ? 0 : count;
    while (index > 0 && is_beyond(index - 1)) --index;
    while (index < count && !is_beyond(index)) ++index;
    return index;
  }
};

/// Takes lane `i` to those of its segments that belong to the slab. Every rank decides so from the
/// same doubles.
HWY_INLINE void keep_to_slab(const SlabBorders& slab, const RaySegments& ray, std::size_t i,
                             RayColumns& rays) {
  double begin = 0, end = ray.count;
  if (ray.way_z > 0) {
    begin = ray.first_beyond(slab.low);
    end = ray.first_beyond(slab.high);
  } else if (ray.way_z < 0) {
    begin = ray.first_beyond(slab.high);
    end = ray.first_beyond(slab.low);
  } else if (!(ray.start_z >= slab.low && ray.start_z < slab.high)) {
    end = 0;
  }
  rays.begin[i] = float(begin);
  rays.segments[i] = float(std::max(begin, end));
  if (end < ray.count) rays.until[i] = rays.segments[i];
}

/// Rays through `count` ≤ kLanes positions; the others miss. Returns whether any ray hits.
HWY_INLINE bool set_up_rays(const KernelScene& scene, const KernelView& view,
                            const PixelPosition* positions, std::size_t count, RayColumns& rays) {
  constexpr std::size_t kWidth = hn::MaxLanes(DoubleTag());
  HWY_ALIGN double x[kLanes], y[kLanes], number[kLanes];
  HWY_ALIGN double entries[kLanes], exits[kLanes], ways_z[kLanes];
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
    const Span span = clip(view.origin, direction, scene.field.size);
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
    hn::Store(entry, kDoubles, entries + i);
    hn::Store(exit, kDoubles, exits + i);
    hn::Store(hn::Mul(direction[2], step), kDoubles, ways_z + i);
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
  for (std::size_t i = 0; i < kLanes; ++i) {
    rays.delay[i] = rays.segments[i] > 0 ? float(number[i] - least) : 0.0F;
    rays.begin[i] = 0;
    rays.until[i] = 1e30F;
    if (scene.slab.is_whole || !(rays.segments[i] > 0)) continue;
    keep_to_slab(
        scene.slab,
        {entries[i], exits[i], number[i], double(rays.segments[i]), view.origin[2], ways_z[i]}, i,
        rays);
  }
  return any;
}

struct Rays {
  Floats3 start, direction;
  Floats first, last, begin, segments, until, delay;

  HWY_INLINE explicit Rays(const RayColumns& rays)
      : start{hn::Load(kFloats, rays.start[0]), hn::Load(kFloats, rays.start[1]),
              hn::Load(kFloats, rays.start[2])},
        direction{hn::Load(kFloats, rays.direction[0]), hn::Load(kFloats, rays.direction[1]),
                  hn::Load(kFloats, rays.direction[2])},
        first(hn::Load(kFloats, rays.first)),
        last(hn::Load(kFloats, rays.last)),
        begin(hn::Load(kFloats, rays.begin)),
        segments(hn::Load(kFloats, rays.segments)),
        until(hn::Load(kFloats, rays.until)),
        delay(hn::Load(kFloats, rays.delay)) {}

  HWY_INLINE FloatMask hit() const { return hn::Gt(segments, begin); }

  /// The position after `steps`, never by adding up.
  HWY_INLINE Floats3 at(Floats steps) const {
    return {hn::MulAdd(steps, direction.x, start.x), hn::MulAdd(steps, direction.y, start.y),
            hn::MulAdd(steps, direction.z, start.z)};
  }

  /// The same, kept from leaving the volume, or the slab, by rounding.
  HWY_INLINE Floats3 at(Floats steps, const FieldLayout& field) const {
    const auto inside = [&](Floats v, Floats low, float high)
                            HWY_ATTR { return hn::Min(hn::Max(v, low), hn::Set(kFloats, high)); };
    const Floats zero = hn::Zero(kFloats);
    return {inside(hn::MulAdd(steps, direction.x, start.x), zero, field.upper[0]),
            inside(hn::MulAdd(steps, direction.y, start.y), zero, field.upper[1]),
            inside(hn::MulAdd(steps, direction.z, start.z), hn::Set(kFloats, field.lower[2]),
                   field.upper[2])};
  }
};

/// Where a packet is whose rays go in step.
class PacketSteps {
 public:
  HWY_INLINE explicit PacketSteps(const Rays& rays) : rays_(rays) {
    const FloatMask hit = rays.hit();
    const Floats far = hn::Set(kFloats, 1e9F);
    const Floats begin = hn::Add(rays.begin, rays.delay);
    const Floats from = hn::Add(hn::Max(hn::Ceil(rays.first), rays.begin), rays.delay);
    const Floats until = hn::Add(hn::Min(hn::Floor(rays.last), rays.segments), rays.delay);
    const Floats end = hn::Add(rays.segments, rays.delay);
    whole_from_ = hn::GetLane(hn::MaxOfLanes(kFloats, hn::IfThenElseZero(hit, from)));
    whole_until_ = hn::GetLane(hn::MinOfLanes(kFloats, hn::IfThenElse(hit, until, far)));
    end_ = hn::GetLane(hn::MaxOfLanes(kFloats, hn::IfThenElseZero(hit, end)));
    step_ = hn::GetLane(hn::MinOfLanes(kFloats, hn::IfThenElse(hit, begin, far)));
    index_ = hn::Sub(hn::Set(kFloats, step_), rays.delay);
  }

  /// The segment that comes next, of each ray; negative before its first.
  HWY_INLINE Floats index() const { return index_; }
  /// Rays that have such a segment.
  HWY_INLINE FloatMask inside() const {
    return hn::And(hn::Ge(index_, rays_.begin), hn::Lt(index_, rays_.segments));
  }
  /// Counted from the packet's first segment.
  HWY_INLINE float step() const { return step_; }
  HWY_INLINE bool ended() const { return step_ >= end_; }
  /// How many steps all rays that hit will have whole segments; 0 if not now.
  HWY_INLINE int whole() const {
    return step_ >= whole_from_ && step_ < whole_until_ ? int(whole_until_ - step_) : 0;
  }
  /// How many steps it takes until then, or until the packet ends.
  HWY_INLINE int until_whole() const {
    const bool comes = step_ < whole_from_ && whole_from_ < whole_until_;
    return int((comes ? whole_from_ : end_) - step_);
  }
  /// Of the steps that rays know about, `known`, the average over `rays`: at least 1, and no more
  /// than an int holds, for a ray may never leave its cells.
  static HWY_INLINE int average(FloatMask rays, Floats known) {
    const float sum = hn::GetLane(hn::SumOfLanes(kFloats, hn::IfThenElseZero(rays, known)));
    return int(std::clamp(sum / float(hn::CountTrue(kFloats, rays)), 1.0F, 1e6F));
  }
  /// Nothing is to be had for as many steps as `known`: on to where the first of `rays` leaves what
  /// it knows, or enters the volume; to the end where none goes on.
  HWY_INLINE void leap(FloatMask rays, Floats known) {
    const Floats far = hn::Set(kFloats, 1e6F);
    const Floats way =
        hn::IfThenElse(hn::Lt(index_, rays_.begin), hn::Sub(rays_.begin, index_), known);
    const FloatMask go_on = hn::And(rays, hn::Lt(index_, rays_.segments));
    advance(hn::GetLane(hn::MinOfLanes(kFloats, hn::IfThenElse(go_on, way, far))));
  }
  HWY_INLINE void advance(float steps) {
    step_ += steps;
    index_ = hn::Add(index_, hn::Set(kFloats, steps));
  }

 private:
  const Rays& rays_;
  Floats index_;
  float step_, whole_from_, whole_until_, end_;
};

#if HWY_TARGET != HWY_SCALAR
/// x, y, z and nothing, of one point.
using PointTag = hn::Simd<float, 4, 0>;
using Point = hn::Vec<PointTag>;
constexpr PointTag kPoint{};

/// The box around all rays of a packet that go in step: where the voxels of their samples lie can
/// be told from it long before the samples themselves are known.
class Beam {
 public:
  HWY_INLINE explicit Beam(const Rays& rays) {
    add(rays, rays.start.x, rays.direction.x, 0);
    add(rays, rays.start.y, rays.direction.y, 1);
    add(rays, rays.start.z, rays.direction.z, 2);
  }

  /// No sample of the middles of segments `first` … `last` lies below, along any axis.
  HWY_INLINE Point lowest(float first, float last) const {
    const Point low = hn::Load(kPoint, low_), change = hn::Load(kPoint, low_change_);
    const Point begin = hn::MulAdd(hn::Set(kPoint, first + 0.5F), change, low);
    const Point end = hn::MulAdd(hn::Set(kPoint, last + 0.5F), change, low);
    return hn::Min(begin, end);
  }

  /// Whether all samples of any `together` successive segments from `first` to `last` lie in a box
  /// of the given edges.
  HWY_INLINE bool is_narrow(float first, float last, int together, const float (&edges)[3]) const {
    for (int axis = 0; axis < 3; ++axis) {
      const float width = high_[axis] - low_[axis];
      const float change = high_change_[axis] - low_change_[axis];
      const float widest = width + std::max(change * (first + 0.5F), change * (last + 0.5F));
      const float way = std::max(std::abs(high_change_[axis]), std::abs(low_change_[axis]));
      if (!(widest + float(together - 1) * way <= edges[axis])) return false;
    }
    return true;
  }

  /// Whether the rays are farther apart than any of the edges at both of two segments.
  HWY_INLINE bool is_wide(float first, float last, const float (&edges)[3]) const {
    for (int axis = 0; axis < 3; ++axis) {
      const float width = high_[axis] - low_[axis];
      const float change = high_change_[axis] - low_change_[axis];
      if (width + std::min(change * (first + 0.5F), change * (last + 0.5F)) > edges[axis])
        return true;
    }
    return false;
  }

 private:
  /// More than what rounding may move a sample by, in voxels.
  static constexpr float kSlack = 2e-3F;

  HWY_INLINE void add(const Rays& rays, Floats start, Floats direction, int axis) {
    const FloatMask hit = rays.hit();
    const Floats far = hn::Set(kFloats, 1e30F),
                 at_zero = hn::NegMulAdd(rays.delay, direction, start);
    const auto least = [&](Floats v) HWY_ATTR {
      return hn::GetLane(hn::MinOfLanes(kFloats, hn::IfThenElse(hit, v, far)));
    };
    low_[axis] = least(at_zero) - kSlack;
    low_change_[axis] = least(direction);
    high_[axis] = -least(hn::Neg(at_zero)) + kSlack;
    high_change_[axis] = -least(hn::Neg(direction));
  }

  alignas(16) float low_[4] = {}, low_change_[4] = {};  ///< at step 0, and per step
  float high_[3], high_change_[3];
};
#endif

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
