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
        steps_(rays) {}

  HWY_INLINE std::uint64_t run() {
    const FloatMask hit = rays_.hit();
    consider(hit, rays_.first);
    consider(hit, rays_.last);
    for (int known = next_promising(); known > 0; known = next_promising()) {
      // What to beat is asked one run late, so that nothing waits for the last sample.
      const Floats before = best_;
      for (; known > 0 && !steps_.ended(); --known) {
        const Segment segment = segment_of(rays_, steps_.index());
        consider(steps_.inside(), middle(segment.begin, segment.end));
        steps_.advance(1);
      }
      to_beat_ = before;
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

  /// Goes on to the next step in which any ray may find more. Returns how many steps to take
  /// before the cells are asked again, 0 when all rays have ended. What a ray takes along in the
  /// company of others is never more than its greatest value.
  HWY_INLINE int next_promising() {
    while (!steps_.ended()) {
      const Floats index = steps_.index();
      const Segment segment = segment_of(rays_, index);
      const Floats at = middle(segment.begin, segment.end);
      const auto cube = walk_.look_for_more(rays_.at(at, scene_.field.upper), at, to_beat_);
      const FloatMask promising = hn::And(steps_.inside(), cube.visible);
      const Floats known = hn::Sub(segment_after(index, cube.exit), index);
      if (!hn::AllFalse(kFloats, promising)) {
        const float sum =
            hn::GetLane(hn::SumOfLanes(kFloats, hn::IfThenElseZero(promising, known)));
        return std::max(1, int(sum / float(hn::CountTrue(kFloats, promising))));
      }
      const Floats far = hn::Set(kFloats, 1e6F);
      const Floats dull = hn::IfThenElse(hn::Lt(index, hn::Zero(kFloats)), hn::Neg(index), known);
      const FloatMask counts = hn::And(rays_.hit(), hn::Lt(index, rays_.segments));
      const Floats way = hn::MinOfLanes(kFloats, hn::IfThenElse(counts, dull, far));
      steps_.advance(hn::GetLane(way));
    }
    return 0;
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

  PacketSteps steps_;
  Floats to_beat_ = hn::Set(kFloats, -std::numeric_limits<float>::infinity());
  Floats best_ = hn::Set(kFloats, -std::numeric_limits<float>::infinity());
  Floats best_at_ = hn::Zero(kFloats);
  std::uint64_t samples_ = 0;
};

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
