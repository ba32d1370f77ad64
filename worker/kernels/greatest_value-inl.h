// SPDX-License-Identifier: Apache-2.0
// The kernel for maximum intensity projection: the greatest value of the field along each ray.
// Cells that hold nothing greater than what a ray has found are leapt over. The best sample is
// refined between its neighbours afterwards, so that the step hardly shows.

#if defined(GOLDTHREAD_WORKER_KERNELS_GREATEST_VALUE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_GREATEST_VALUE_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_GREATEST_VALUE_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_GREATEST_VALUE_INL_H_
#endif

#include "worker/kernels/cell_walk-inl.h"
#include "worker/kernels/field-inl.h"
#include "worker/kernels/ray_packet-inl.h"
#include "worker/kernels/transfer-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

template <Storage kStorage>
class GreatestValue {
 public:
  HWY_INLINE GreatestValue(const CastArguments& arguments, const Rays& rays)
      : scene_(arguments.scene),
        field_(arguments.scene.field),
        rays_(rays),
        walk_(arguments.scene, rays),
        index_(hn::Neg(rays.delay)) {}

  HWY_INLINE std::uint64_t run() {
    const FloatMask hit = hn::Gt(rays_.segments, hn::Zero(kFloats));
    consider(hit, rays_.first);
    consider(hit, rays_.last);
    alive_ = hit;
    while (next()) {
      const Segment segment = segment_of(rays_, index_);
      consider(hn::And(alive_, hn::Ge(index_, dark_until_)), middle(segment.begin, segment.end));
      index_ = hn::Add(index_, hn::Set(kFloats, 1.0F));
      alive_ = hn::And(alive_, hn::Lt(index_, rays_.segments));
    }
    refine(hit);
    return samples_;
  }

  HWY_INLINE Floats3 color() const {
    const Optics optics = look_up(scene_.transfer, hn::IfThenElseZero(found(), best_));
    return {hn::IfThenElseZero(found(), optics.color.x),
            hn::IfThenElseZero(found(), optics.color.y),
            hn::IfThenElseZero(found(), optics.color.z)};
  }
  HWY_INLINE Floats alpha() const { return hn::IfThenElseZero(found(), hn::Set(kFloats, 1.0F)); }

 private:
  /// False where the ray misses the volume, or met nothing but voxels that are not finite.
  HWY_INLINE FloatMask found() const { return is_finite(best_); }

  HWY_INLINE void consider(FloatMask active, Floats steps) {
    const Floats value = field_.value(locate(rays_.at(steps, scene_.field.upper)), active);
    const FloatMask better = hn::And(hn::And(active, is_finite(value)), hn::Gt(value, best_));
    best_ = hn::IfThenElse(better, value, best_);
    best_at_ = hn::IfThenElse(better, steps, best_at_);
    samples_ += hn::CountTrue(kFloats, active);
  }

  /// Goes on to the next segment in which any ray may find more; false when all have ended. What a
  /// ray takes along in the company of others can only be less than the best: never more.
  HWY_INLINE bool next() {
    while (true) {
      const FloatMask unsure = hn::And(alive_, hn::Ge(index_, known_until_));
      if (!hn::AllFalse(kFloats, unsure)) look(unsure);
      if (!hn::AllFalse(kFloats, hn::And(alive_, hn::Ge(index_, dark_until_)))) return true;
      if (hn::AllFalse(kFloats, alive_)) return false;
      const Floats far = hn::Set(kFloats, 1e30F);
      const Floats way = hn::IfThenElse(alive_, hn::Sub(dark_until_, index_), far);
      index_ = hn::Add(index_, hn::MinOfLanes(kFloats, way));
      alive_ = hn::And(alive_, hn::Lt(index_, rays_.segments));
    }
  }

  HWY_INLINE void look(FloatMask unsure) {
    const Segment segment = segment_of(rays_, index_);
    const Floats steps = middle(segment.begin, segment.end);
    const auto cube = walk_.look_for_more(rays_.at(steps, scene_.field.upper), steps, best_);
    const Floats until = segment_after(index_, cube.exit);
    known_until_ = hn::IfThenElse(unsure, until, known_until_);
    dark_until_ = hn::IfThenElse(hn::AndNot(cube.visible, unsure), until, dark_until_);
  }

  /// Samples densely about the best one, twice.
  HWY_INLINE void refine(FloatMask hit) {
    constexpr int kSide = 4;
    float reach = 1.0F;
    for (int round = 0; round < 2; ++round) {
      const Floats centre = best_at_;
      for (int i = -kSide; i <= kSide; ++i) {
        if (i == 0) continue;
        const Floats offset = hn::Set(kFloats, reach * float(i) / (kSide + 1));
        const Floats steps = hn::Add(centre, offset);
        consider(hit, hn::Min(hn::Max(steps, rays_.first), rays_.last));
      }
      reach /= kSide + 1;
    }
  }

  const KernelScene& scene_;
  Field<kStorage, false> field_;
  const Rays& rays_;
  CellWalk walk_;

  Floats index_;
  FloatMask alive_ = hn::Gt(hn::Zero(kFloats), hn::Zero(kFloats));
  Floats known_until_ = hn::Zero(kFloats);
  Floats dark_until_ = hn::Zero(kFloats);
  Floats best_ = hn::Set(kFloats, -std::numeric_limits<float>::infinity());
  Floats best_at_ = hn::Zero(kFloats);
  std::uint64_t samples_ = 0;
};

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
