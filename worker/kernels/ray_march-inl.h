// SPDX-License-Identifier: Apache-2.0
// The kernel for emission and absorption and for isosurfaces. A lane keeps its own place along its
// ray; lanes share instructions and nothing else, so that a ray's result is the same to the bit in
// any company. Emission and absorption: the midpoint rule with exact opacity per segment, second
// order in the step. Surfaces: a change of sign between the ends of a segment, refined inside it.

#if defined(GOLDTHREAD_WORKER_KERNELS_RAY_MARCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_RAY_MARCH_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_RAY_MARCH_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_RAY_MARCH_INL_H_
#endif

#include "worker/kernels/cell_walk-inl.h"
#include "worker/kernels/field-inl.h"
#include "worker/kernels/ray_packet-inl.h"
#include "worker/kernels/shading-inl.h"
#include "worker/kernels/transfer-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

template <class FieldType, Features kFeatures>
class RayMarch {
 public:
  HWY_INLINE RayMarch(const CastArguments& arguments, const Rays& rays)
      : scene_(arguments.scene),
        lights_(arguments.view.lights),
        field_(arguments.scene.field),
        rays_(rays),
        walk_(arguments.scene, rays),
        step_mm_(hn::Set(kFloats, float(arguments.scene.step_mm))) {}

  /// Casts the packet; returns how many field values were taken for results.
  HWY_INLINE std::uint64_t run() {
    FloatMask active = hn::Gt(rays_.segments, hn::Zero(kFloats));
    while (true) {
      active = advance(active);
      if (hn::AllFalse(kFloats, active)) return samples_;
      // Until a lane leaves what it knows about, all sample.
      FloatMask unsure;
      do {
        sample(active);
        index_ = hn::IfThenElse(active, hn::Add(index_, hn::Set(kFloats, 1.0F)), index_);
        active = hn::And(active, hn::Lt(index_, rays_.segments));
        active = hn::And(active, hn::Gt(transmittance_, hn::Set(kFloats, kLeastTransmittance)));
        unsure = hn::And(active, hn::Ge(index_, known_until_));
      } while (hn::AllFalse(kFloats, unsure) && !hn::AllFalse(kFloats, active));
    }
  }

  HWY_INLINE const Floats3& color() const { return color_; }
  HWY_INLINE Floats alpha() const { return alpha_; }

 private:
  /// Takes each lane that needs it to its next segment that may show something.
  HWY_INLINE FloatMask advance(FloatMask active) {
    FloatMask unsure = hn::And(active, hn::Ge(index_, known_until_));
    while (!hn::AllFalse(kFloats, unsure)) {
      const Segment segment = segment_of(rays_, index_);
      // A surface may lie anywhere in a segment, so all of it must be empty; otherwise only the
      // middle is ever looked at.
      const Floats steps =
          kFeatures.isosurfaces ? segment.begin : middle(segment.begin, segment.end);
      const auto cube = walk_.look(rays_.at(steps, scene_.field.upper), steps);
      Floats target;
      FloatMask leap;
      if constexpr (kFeatures.isosurfaces) {
        target = hn::Floor(cube.exit);
        leap = hn::AndNot(cube.visible, hn::And(unsure, hn::Gt(target, index_)));
        const Floats next = hn::Add(index_, hn::Set(kFloats, 1.0F));
        const Floats visible_until = hn::Max(next, hn::Ceil(cube.exit));
        const Floats until =
            hn::IfThenElse(leap, target, hn::IfThenElse(cube.visible, visible_until, next));
        known_until_ = hn::IfThenElse(unsure, until, known_until_);
        value_is_stale_ = hn::Or(value_is_stale_, leap);
      } else {
        target = segment_after(index_, cube.exit);
        leap = hn::AndNot(cube.visible, unsure);
        known_until_ = hn::IfThenElse(unsure, target, known_until_);
      }
      index_ = hn::IfThenElse(leap, target, index_);
      active = hn::And(active, hn::Lt(index_, rays_.segments));
      unsure = hn::And(hn::And(active, leap), hn::Ge(index_, known_until_));
    }
    return active;
  }

  HWY_INLINE void sample(FloatMask active) {
    const Segment segment = segment_of(rays_, index_);
    if constexpr (kFeatures.isosurfaces) {
      sample_between_surfaces(active, segment);
    } else {
      add_interval(active, segment.begin, segment.end);
    }
  }

  HWY_INLINE Floats value_at(Floats steps) const {
    return field_.value(field_.locate(rays_.at(steps, scene_.field.upper)));
  }

  /// Emission and absorption of [begin, end], from the field in its middle.
  HWY_INLINE void add_interval(FloatMask active, Floats begin, Floats end) {
    const Floats3 position = rays_.at(middle(begin, end), scene_.field.upper);
    const auto place = field_.locate(position);
    const auto words = field_.words(place);
    const Floats value = field_.value(place, words);
    samples_ += hn::CountTrue(kFloats, active);
    const FloatMask seen = hn::And(active, is_finite(value));
    const Optics optics = look_up(scene_.transfer, hn::IfThenElseZero(seen, value));
    const Floats length = hn::Mul(hn::Sub(end, begin), step_mm_);
    const Floats depth = hn::IfThenElseZero(seen, hn::Mul(optics.extinction, length));
    if (hn::AllFalse(kFloats, hn::Gt(depth, hn::Zero(kFloats)))) return;
    Floats3 color = optics.color;
    if constexpr (kFeatures.shading) {
      color =
          shade(scene_.phong, lights_, color, field_.gradient(place, words), position, rays_.direction);
    }
    composite(color, one_minus_exp(depth));
  }

  HWY_INLINE void composite(const Floats3& color, Floats opacity) {
    const Floats weight = hn::Mul(transmittance_, opacity);
    color_.x = hn::MulAdd(weight, color.x, color_.x);
    color_.y = hn::MulAdd(weight, color.y, color_.y);
    color_.z = hn::MulAdd(weight, color.z, color_.z);
    // Opacity is summed up, not transmittance taken down: what is thin keeps its digits.
    alpha_ = hn::Add(alpha_, weight);
    transmittance_ = hn::Sub(hn::Set(kFloats, 1.0F), alpha_);
  }

  /// Goes through the surfaces of a segment in the order in which a rising or falling field meets
  /// them, and through what lies before, between and behind them.
  HWY_INLINE void sample_between_surfaces(FloatMask active, const Segment& segment) {
    const FloatMask stale = hn::And(active, value_is_stale_);
    if (!hn::AllFalse(kFloats, stale)) {
      value_ = hn::IfThenElse(stale, value_at(segment.begin), value_);
      samples_ += hn::CountTrue(kFloats, stale);
      value_is_stale_ = hn::AndNot(active, value_is_stale_);
    }
    const Floats next_value = value_at(segment.end);
    samples_ += hn::CountTrue(kFloats, active);
    const FloatMask usable = hn::And(active, hn::And(is_finite(value_), is_finite(next_value)));
    const FloatMask rising = hn::Lt(value_, next_value);
    const std::size_t count = scene_.surfaces.size();
    Floats from = segment.begin;
    for (std::size_t i = 0; i < count; ++i) {
      const SurfaceTerm& up = scene_.surfaces[i];
      const SurfaceTerm& down = scene_.surfaces[count - 1 - i];
      const Floats isovalue =
          hn::IfThenElse(rising, hn::Set(kFloats, up.value), hn::Set(kFloats, down.value));
      const auto before = hn::Lt(value_, isovalue), behind = hn::Lt(next_value, isovalue);
      const FloatMask hit = hn::And(usable, hn::Xor(before, behind));
      if (hn::AllFalse(kFloats, hit)) continue;
      const Floats at = hn::Max(from, refine(segment, hn::Sub(value_, isovalue),
                                             hn::Sub(next_value, isovalue), isovalue));
      const Floats until = hn::IfThenElse(hit, at, from);
      if constexpr (kFeatures.dvr) add_interval(hit, from, until);
      add_surface(hit, until, rising, up, down);
      from = until;
    }
    if constexpr (kFeatures.dvr) add_interval(active, from, segment.end);
    value_ = hn::IfThenElse(active, next_value, value_);
  }

  /// Where the field takes the isovalue inside a segment at whose ends its signs differ: false
  /// position, the end that stays halved (Illinois; Dowell and Jarratt 1971).
  HWY_INLINE Floats refine(const Segment& segment, Floats at_begin, Floats at_end,
                           Floats isovalue) {
    constexpr int kRounds = 6;
    const Floats zero = hn::Zero(kFloats), half = hn::Set(kFloats, 0.5F);
    Floats begin = segment.begin, end = segment.end, root = begin;
    for (int round = 0; round < kRounds; ++round) {
      const Floats difference = hn::Sub(at_end, at_begin);
      const auto flat = hn::Eq(difference, zero);
      const Floats fraction =
          hn::Div(hn::Neg(at_begin), hn::IfThenElse(flat, hn::Set(kFloats, 1.0F), difference));
      // A bad voxel between the ends makes the fraction NaN.
      const Floats usable = hn::IfThenElseZero(is_finite(fraction), fraction);
      const Floats inside = hn::Min(hn::Max(usable, zero), hn::Set(kFloats, 1.0F));
      root = hn::MulAdd(inside, hn::Sub(end, begin), begin);
      const Floats at_root = hn::Sub(value_at(root), isovalue);
      const auto other_side = hn::Xor(hn::Lt(at_root, zero), hn::Lt(at_begin, zero));
      at_end = hn::IfThenElse(other_side, at_root, hn::Mul(at_end, half));
      at_begin = hn::IfThenElse(other_side, hn::Mul(at_begin, half), at_root);
      end = hn::IfThenElse(other_side, root, end);
      begin = hn::IfThenElse(other_side, begin, root);
    }
    return root;
  }

  HWY_INLINE void add_surface(FloatMask hit, Floats steps, FloatMask rising, const SurfaceTerm& up,
                              const SurfaceTerm& down) {
    const auto chosen = [&](float a, float b) HWY_ATTR {
      return hn::IfThenElse(rising, hn::Set(kFloats, a), hn::Set(kFloats, b));
    };
    Floats3 color{chosen(up.color[0], down.color[0]), chosen(up.color[1], down.color[1]),
                  chosen(up.color[2], down.color[2])};
    if constexpr (kFeatures.shading) {
      const Floats3 position = rays_.at(steps, scene_.field.upper);
      const auto place = field_.locate(position);
      color = shade(scene_.phong, lights_, color, field_.gradient(place, field_.words(place)),
                    position, rays_.direction);
    }
    composite(color, hn::IfThenElseZero(hit, chosen(up.opacity, down.opacity)));
  }

  const KernelScene& scene_;
  const std::vector<LightTerm>& lights_;
  FieldType field_;
  const Rays& rays_;
  CellWalk walk_;
  Floats step_mm_;

  Floats index_ = hn::Zero(kFloats);        ///< the segment that comes next
  Floats known_until_ = hn::Zero(kFloats);  ///< from this segment on the cells must be asked
  Floats alpha_ = hn::Zero(kFloats);
  Floats transmittance_ = hn::Set(kFloats, 1.0F);  ///< 1 − alpha_
  Floats3 color_{hn::Zero(kFloats), hn::Zero(kFloats), hn::Zero(kFloats)};
  Floats value_ = hn::Zero(kFloats);  ///< of the field where segment index_ begins
  FloatMask value_is_stale_ = hn::MaskFromVec(hn::BitCast(kFloats, hn::Set(kInts, -1)));
  std::uint64_t samples_ = 0;
};

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
