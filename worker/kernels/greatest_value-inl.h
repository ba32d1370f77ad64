// SPDX-License-Identifier: Apache-2.0
// The kernel for maximum intensity projection: the greatest value of the field along each ray.
// Cells that hold nothing greater than what a ray has found are leapt over. In the voxel cell of
// the best sample and in the ones before and behind it the greatest value is taken exactly, so that
// the step hardly shows.

#if defined(GOLDTHREAD_WORKER_KERNELS_GREATEST_VALUE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_GREATEST_VALUE_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_GREATEST_VALUE_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_GREATEST_VALUE_INL_H_
#endif

#include "worker/kernels/cell_cubic-inl.h"
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
        stage_(arguments.stage),
        rays_(rays),
        walk_(arguments.scene, rays),
        steps_(rays)
#if HWY_TARGET != HWY_SCALAR
        ,
        beam_(rays)
#endif
  {
  }

  HWY_INLINE std::uint64_t run() {
    if (stage_.marches) march();
    if (stage_.completes) refine(has_best());
    return samples_;
  }

  /// Rays bring what they have found in the slabs before.
  HWY_INLINE void resume(Floats best, Floats best_at) {
    best_ = to_beat_ = best;
    best_at_ = best_at;
  }
  HWY_INLINE Floats best() const { return best_; }
  HWY_INLINE Floats best_at() const { return best_at_; }

  HWY_INLINE Floats3 color() const {
    const Optics optics = look_up(scene_.transfer, hn::IfThenElseZero(found(), best_));
    return {hn::IfThenElseZero(found(), optics.color.x),
            hn::IfThenElseZero(found(), optics.color.y),
            hn::IfThenElseZero(found(), optics.color.z)};
  }
  HWY_INLINE Floats alpha() const { return hn::IfThenElseZero(found(), hn::Set(kFloats, 1.0F)); }

 private:
  HWY_INLINE void march() {
    const FloatMask hit = rays_.hit();
    consider(hn::And(hit, hn::Eq(rays_.begin, hn::Zero(kFloats))), rays_.first);
    for (int known = next_promising(); known > 0; known = next_promising()) {
      // What to beat is asked one run late, so that nothing waits for the last sample.
      const Floats before = best_;
      if (const int whole = steps_.whole(); whole > 0) {
        take_whole(std::min(known, whole));
      } else {
        take_parts(std::min(known, steps_.until_whole()));
      }
      to_beat_ = before;
    }
    // Last, as through slabs: of equal values the first one counts.
    consider(hn::And(hit, hn::Gt(rays_.until, rays_.last)), rays_.last);
  }

  /// Rays whose greatest value lies in this slab.
  HWY_INLINE FloatMask has_best() const {
    const FloatMask inside = hn::And(hn::Ge(best_at_, rays_.begin), hn::Lt(best_at_, rays_.until));
    return hn::And(rays_.hit(), inside);
  }

  /// False where the ray misses the volume, or met nothing but voxels that are not finite.
  HWY_INLINE FloatMask found() const { return is_finite(best_); }

  HWY_INLINE void consider(FloatMask active, Floats steps) {
    consider(active, steps, field_.value(locate(rays_.at(steps, scene_.field)), active));
  }
  HWY_INLINE void consider(FloatMask active, Floats steps, Floats value) {
    const FloatMask better = hn::And(hn::And(active, is_finite(value)), hn::Gt(value, best_));
    best_ = hn::IfThenElse(better, value, best_);
    best_at_ = hn::IfThenElse(better, steps, best_at_);
    samples_ += hn::CountTrue(kFloats, active);
  }

  HWY_INLINE void take_parts(int steps) {
    for (; steps > 0; --steps) {
      const Segment segment = segment_of(rays_, steps_.index());
      consider(steps_.inside(), middle(segment.begin, segment.end));
      steps_.advance(1);
    }
  }

  /// Steps in which all rays have whole segments.
  HWY_INLINE void take_whole(int steps) {
#if HWY_TARGET != HWY_SCALAR
    const float first = steps_.step(), last = first + float(steps - 1);
    if (steps >= kTogether && beam_.is_narrow(first, last, kTogether, FieldType::kBeamEdges)) {
      for (; steps >= kTogether; steps -= kTogether) take_together<false>();
    } else if (beam_.is_wide(first, last, FieldType::kMostEdges)) {
      for (; steps >= kTogether; steps -= kTogether) take_together<true>();
    }
#endif
    take_parts(steps);
  }

#if HWY_TARGET != HWY_SCALAR
  static constexpr int kTogether = 3;
  static constexpr int kAhead = 12;
  template <bool kApart>
  HWY_INLINE void take_together() {
    Floats middles[kTogether], values[kTogether];
    CellPlace places[kTogether];
    GOLDTHREAD_UNROLL
    for (int i = 0; i < kTogether; ++i) {
      middles[i] = hn::Add(steps_.index(), hn::Set(kFloats, 0.5F + float(i)));
      places[i] = locate(rays_.at(middles[i], scene_.field));
    }
    if constexpr (kApart) {
      const Floats ahead = hn::Add(steps_.index(), hn::Set(kFloats, float(kAhead)));
      const CellPlace soon = locate(rays_.at(ahead, scene_.field));
      field_.values_apart(places, soon, rays_.hit(), values);
    } else {
      field_.values(beam_, steps_.step(), places, rays_.hit(), values);
    }
    GOLDTHREAD_UNROLL
    for (int i = 0; i < kTogether; ++i) consider(rays_.hit(), middles[i], values[i]);
    steps_.advance(float(kTogether));
  }
#endif

  /// Goes on to the next step in which any ray may find more. Returns how many steps to take
  /// before the cells are asked again, 0 when all rays have ended. What a ray takes along in the
  /// company of others is never more than its greatest value.
  HWY_INLINE int next_promising() {
    while (!steps_.ended()) {
      const Floats index = steps_.index();
      const Segment segment = segment_of(rays_, index);
      const Floats at = middle(segment.begin, segment.end);
      const auto cube = walk_.look_for_more(rays_.at(at, scene_.field), at, to_beat_);
      const FloatMask promising = hn::And(steps_.inside(), cube.visible);
      const Floats known = hn::Sub(segment_after(index, cube.exit), index);
      if (!hn::AllFalse(kFloats, promising)) return PacketSteps::average(promising, known);
      steps_.leap(rays_.hit(), known);
    }
    return 0;
  }

  /// Where a ray goes through a cell of 2³ voxels.
  struct Passage {
    Floats entry, exit;
  };

  /// Takes the greatest value exactly where the ray passes the cell of the best sample, and its
  /// neighbours.
  HWY_INLINE void refine(FloatMask hit) {
    const FloatMask found_any = hn::And(hit, found());
    const Floats slack = hn::Set(kFloats, 1e-3F);
    const Passage best = refine_at(found_any, best_at_);
    refine_at(found_any, hn::Sub(best.entry, slack));
    refine_at(found_any, hn::Add(best.exit, slack));
  }

  HWY_INLINE Passage refine_at(FloatMask lanes, Floats steps) {
    const Floats inside = hn::Min(hn::Max(steps, rays_.first), rays_.last);
    CellPlace place = locate(rays_.at(inside, scene_.field));
    const Floats3 cell{hn::ConvertTo(kFloats, place.at.x), hn::ConvertTo(kFloats, place.at.y),
                       hn::ConvertTo(kFloats, place.at.z)};
    Passage passage{rays_.first, rays_.last};
    narrow(cell.x, rays_.start.x, rays_.direction.x, passage);
    narrow(cell.y, rays_.start.y, rays_.direction.y, passage);
    narrow(cell.z, rays_.start.z, rays_.direction.z, passage);
    // Rounding must not carry a ray that is nearly parallel to a face away from its cell.
    passage.entry = hn::Min(passage.entry, inside);
    passage.exit = hn::Max(passage.exit, inside);
    const Floats length = hn::Sub(passage.exit, passage.entry);
    Floats corners[8];
    field_.cell(place, lanes, corners);
    const Floats3 at = rays_.at(passage.entry);
    const CellCubic cubic(corners,
                          {hn::Sub(at.x, cell.x), hn::Sub(at.y, cell.y), hn::Sub(at.z, cell.z)},
                          {hn::Mul(length, rays_.direction.x), hn::Mul(length, rays_.direction.y),
                           hn::Mul(length, rays_.direction.z)});
    consider(lanes, best_at_, cubic.greatest());
    return passage;
  }

  /// Between the cell's two faces along one axis.
  static HWY_INLINE void narrow(Floats cell, Floats start, Floats direction, Passage& passage) {
    const auto moves = hn::Gt(hn::Abs(direction), hn::Set(kFloats, 1e-20F));
    const Floats one = hn::Set(kFloats, 1.0F);
    const Floats per_step = hn::Div(one, hn::IfThenElse(moves, direction, one));
    const Floats low = hn::Mul(hn::Sub(cell, start), per_step);
    const Floats high = hn::Mul(hn::Sub(hn::Add(cell, one), start), per_step);
    const Floats entry = hn::Max(passage.entry, hn::Min(low, high));
    const Floats exit = hn::Min(passage.exit, hn::Max(low, high));
    passage = {hn::IfThenElse(moves, entry, passage.entry),
               hn::IfThenElse(moves, exit, passage.exit)};
  }

  using FieldType = Field<kStorage, false>;

  const KernelScene& scene_;
  FieldType field_;
  Stage stage_;
  const Rays& rays_;
  CellWalk walk_;

  PacketSteps steps_;
#if HWY_TARGET != HWY_SCALAR
  Beam beam_;
#endif
  Floats to_beat_ = hn::Set(kFloats, -std::numeric_limits<float>::infinity());
  Floats best_ = hn::Set(kFloats, -std::numeric_limits<float>::infinity());
  Floats best_at_ = hn::Zero(kFloats);
  std::uint64_t samples_ = 0;
};

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
