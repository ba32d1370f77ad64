// SPDX-License-Identifier: Apache-2.0
// The kernel for emission and absorption: the midpoint rule with exact opacity per segment, second
// order in the step. The rays of a packet go in step, at equal distance from the camera, so that
// their samples stay close together; a ray's result is the same to the bit in any company.

#if defined(GOLDTHREAD_WORKER_KERNELS_RAY_MARCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_RAY_MARCH_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_RAY_MARCH_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_RAY_MARCH_INL_H_
#endif

#include "worker/kernels/accumulation-inl.h"
#include "worker/kernels/cell_walk-inl.h"
#include "worker/kernels/field-inl.h"
#include "worker/kernels/ray_packet-inl.h"
#include "worker/kernels/shading-inl.h"
#include "worker/kernels/transfer-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

template <Storage kStorage, bool kShading>
class RayMarch {
 public:
  HWY_INLINE RayMarch(const CastArguments& arguments, const Rays& rays)
      : scene_(arguments.scene),
        field_(arguments.scene.field),
        rays_(rays),
        walk_(arguments.scene, rays_),
        shading_(arguments.scene.phong, arguments.view.lights, rays.direction),
        step_mm_(float(arguments.scene.step_mm)),
        index_(hn::Neg(rays.delay)),
        alive_(hn::Gt(rays.segments, hn::Zero(kFloats))) {}

  /// Returns how many samples were taken.
  HWY_INLINE std::uint64_t run() {
    for (int steps = prepare(); steps > 0; steps = prepare()) {
      for (; steps > 0 && !hn::AllFalse(kFloats, alive_); --steps) {
        add_segment();
        index_ = hn::Add(index_, hn::Set(kFloats, 1.0F));
        alive_ = hn::And(alive_, hn::And(hn::Lt(index_, rays_.segments), sum_.is_open()));
      }
    }
    return samples_;
  }

  HWY_INLINE const Accumulation& sum() const { return sum_; }

 private:
  /// Goes on to the next segment in which any ray may see something. Returns how many segments to
  /// take before the cells are asked again, 0 when all rays have ended.
  HWY_INLINE int prepare() {
    while (!hn::AllFalse(kFloats, alive_)) {
      const FloatMask unsure = hn::And(alive_, hn::Ge(index_, known_until_));
      if (!hn::AllFalse(kFloats, unsure)) look(unsure);
      const FloatMask light = hn::And(alive_, hn::Ge(index_, dark_until_));
      if (!hn::AllFalse(kFloats, light)) return steps_known(light);
      leap();
    }
    return 0;
  }

  /// On average. What is sampled beyond what a ray knows adds exactly 0 if it is empty, so that
  /// rays may wait for each other.
  HWY_INLINE int steps_known(FloatMask light) const {
    const Floats known = hn::IfThenElseZero(light, hn::Sub(known_until_, index_));
    const float sum = hn::GetLane(hn::SumOfLanes(kFloats, known));
    return std::max(1, int(sum / float(hn::CountTrue(kFloats, light))));
  }

  /// Asks the cells of `unsure` rays until where they know what comes.
  HWY_INLINE void look(FloatMask unsure) {
    const Segment segment = segment_of(rays_, index_);
    const Floats steps = middle(segment.begin, segment.end);
    const auto cube = walk_.look(rays_.at(steps, scene_.field.upper), steps);
    const Floats until = segment_after(index_, cube.exit);
    known_until_ = hn::IfThenElse(unsure, until, known_until_);
    dark_until_ = hn::IfThenElse(hn::AndNot(cube.visible, unsure), until, dark_until_);
  }

  /// All rays are in the dark: on to where the first of them leaves it.
  HWY_INLINE void leap() {
    const Floats far = hn::Set(kFloats, 1e30F);
    const Floats way = hn::IfThenElse(alive_, hn::Sub(dark_until_, index_), far);
    index_ = hn::Add(index_, hn::MinOfLanes(kFloats, way));
    alive_ = hn::And(alive_, hn::Lt(index_, rays_.segments));
  }

  /// Emission and absorption of each ray's next segment, from the field in its middle. Nothing but
  /// the sums waits for the opacity of the segments before: these are far behind when the next
  /// samples are begun.
  HWY_INLINE void add_segment() {
    const Segment segment = segment_of(rays_, index_);
    const Floats3 position = rays_.at(middle(segment.begin, segment.end), scene_.field.upper);
    const CellPlace place = locate(position);
    const FloatMask present =
        hn::And(hn::Ge(index_, hn::Zero(kFloats)), hn::Lt(index_, rays_.segments));
    const Floats value = field_.value(place, present);
    samples_ += hn::CountTrue(kFloats, alive_);
    FloatMask seen = hn::And(alive_, present);
    Floats usable = value;
    if constexpr (FieldType::kMayBeInfinite) {
      const FloatMask finite = is_finite(value);
      seen = hn::And(seen, finite);
      usable = hn::IfThenElseZero(finite, value);
    }
    Look look = look_at(scene_.transfer, usable, hn::Sub(segment.end, segment.begin), step_mm_);
    if constexpr (kShading) {
      const FloatMask visible = hn::And(seen, hn::Gt(look.opacity, hn::Zero(kFloats)));
      if (hn::AllFalse(kFloats, visible)) return;
      look.color = shading_.shade(look.color, field_.gradient(place, visible), position);
    }
    sum_.add(look.color, hn::IfThenElseZero(seen, look.opacity));
  }

  using FieldType = Field<kStorage, kShading>;

  const KernelScene& scene_;
  FieldType field_;
  const Rays& rays_;
  CellWalk walk_;
  PhongShading shading_;
  float step_mm_;

  Floats index_;  ///< the segment that comes next, of each ray; negative before its first
  FloatMask alive_;
  Floats known_until_ = hn::Zero(kFloats);  ///< from this segment on the cells must be asked
  Floats dark_until_ = hn::Zero(kFloats);   ///< before this segment nothing can be seen
  Accumulation sum_;
  std::uint64_t samples_ = 0;
};

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
