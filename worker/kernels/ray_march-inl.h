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
#include "worker/kernels/ray_queue-inl.h"
#include "worker/kernels/shading-inl.h"
#include "worker/kernels/transfer-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

template <class FieldType, Features kFeatures>
class RayMarch {
 public:
  HWY_INLINE explicit RayMarch(const CastArguments& arguments)
      : scene_(arguments.scene),
        lights_(arguments.view.lights),
        field_(arguments.scene.field),
        rays_(lanes_.rays, 0),
        walk_(arguments.scene, rays_),
        step_mm_(float(arguments.scene.step_mm)) {}

  /// Gives free lanes new rays and takes each lane to its next segment that may show something.
  /// False once neither the packet nor the queue has a ray left; then all results are handed over.
  HWY_INLINE bool prepare(RayQueue& queue) {
    while (true) {
      const std::size_t busy = hn::CountTrue(kFloats, active_);
      const bool drained = queue.empty();
      if (busy == 0 && drained && !holds_results_) return false;
      if (busy == 0 || (!drained && busy <= kLanes - kRefill)) refill(queue);
      active_ = advance(active_);
      running_ = hn::CountTrue(kFloats, active_);
      if (running_ > 0) return true;
    }
  }

  /// What a sample needs of the field. Fetched for two packets before either goes on, so that one's
  /// arithmetic hides the other's waiting for memory.
  struct Fetched {
    Floats3 position;
    typename FieldType::Place place;
    typename FieldType::Words words;
    Floats steps;  ///< how long the segment is
  };
  HWY_INLINE Fetched fetch() const {
    const Segment segment = segment_of(rays_, index_);
    return fetch(segment.begin, segment.end);
  }

  /// One segment of each lane, its field fetched before.
  HWY_INLINE void step(const Fetched& fetched) {
    add_interval(active_, fetched);
    finish_segment();
  }
  /// The same with all its work at once; surfaces need more of the field than can be told before.
  HWY_INLINE void step() {
    sample_between_surfaces(active_, segment_of(rays_, index_));
    finish_segment();
  }

  /// Whether the next step may follow without prepare().
  HWY_INLINE bool may_go_on() const {
    if (running_ == 0) return true;  // nothing to do: no reason to stop another packet
    const FloatMask unsure = hn::And(active_, hn::Ge(index_, known_until_));
    const std::size_t left = hn::CountTrue(kFloats, active_);
    return left > 0 && left + kRefill > running_ && !must_look(unsure, left);
  }

  /// Field values taken for results.
  HWY_INLINE std::uint64_t samples() const { return samples_; }

 private:
  /// A packet takes new rays when this many of its lanes have none.
  static constexpr std::size_t kRefill = kLanes >= 4 ? kLanes / 4 : 1;

  /// What a lane owns, in memory, while lanes are given to other rays.
  struct alignas(64) Lanes {
    RayLanes rays = {};
    float index[kLanes] = {}, known_until[kLanes] = {}, value[kLanes] = {}, stale[kLanes] = {};
    float alpha[kLanes] = {}, color[3][kLanes] = {};
    Sample* place[kLanes] = {};  ///< null: the lane has no ray
  };

  /// Whether lanes that have left what they know about must look around now. Emission and
  /// absorption may as well sample what turns out to be empty: it adds exactly 0. So they wait for
  /// company.
  static HWY_INLINE bool must_look(FloatMask unsure, std::size_t active) {
    if constexpr (kFeatures.isosurfaces) return !hn::AllFalse(kFloats, unsure);
    return 2 * hn::CountTrue(kFloats, unsure) >= active;
  }

  HWY_INLINE void hand_over(std::size_t lane) {
    const float alpha = lanes_.alpha[lane];
    const bool opaque = 1.0F - alpha <= kLeastTransmittance;
    const float share = opaque ? 1.0F / alpha : 1.0F;
    *lanes_.place[lane] = {lanes_.color[0][lane] * share, lanes_.color[1][lane] * share,
                           lanes_.color[2][lane] * share, opaque ? 1.0F : alpha};
  }

  HWY_INLINE void finish_segment() {
    // Of all lanes: were it of the active ones, the next sample's address would wait for this one's
    // opacity.
    index_ = hn::Add(index_, hn::Set(kFloats, 1.0F));
    active_ = hn::And(active_, hn::Lt(index_, rays_.segments));
    active_ = hn::And(active_, hn::Gt(transmittance_, hn::Set(kFloats, kLeastTransmittance)));
  }

  /// Hands over the results of the lanes that are not active and gives them the next rays.
  HWY_INLINE void refill(RayQueue& queue) {
    HWY_ALIGN float running[kLanes];
    hn::Store(hn::IfThenElseZero(active_, hn::Set(kFloats, 1.0F)), kFloats, running);
    store_lanes();
    holds_results_ = false;
    for (std::size_t i = 0; i < kLanes; ++i) {
      if (running[i] == 0) {
        if (lanes_.place[i] != nullptr) {
          hand_over(i);
        }
        lanes_.place[i] = queue.empty() ? nullptr : queue.take(lanes_.rays, i);
        running[i] = lanes_.place[i] != nullptr ? 1.0F : 0.0F;
        lanes_.index[i] = lanes_.known_until[i] = lanes_.value[i] = lanes_.alpha[i] = 0;
        lanes_.color[0][i] = lanes_.color[1][i] = lanes_.color[2][i] = 0;
        lanes_.stale[i] = 1;
      }
      holds_results_ = holds_results_ || lanes_.place[i] != nullptr;
    }
    load_lanes();
    active_ = hn::Gt(hn::Load(kFloats, running), hn::Zero(kFloats));
  }

  HWY_INLINE void store_lanes() {
    hn::Store(index_, kFloats, lanes_.index);
    hn::Store(known_until_, kFloats, lanes_.known_until);
    hn::Store(alpha_, kFloats, lanes_.alpha);
    hn::Store(color_.x, kFloats, lanes_.color[0]);
    hn::Store(color_.y, kFloats, lanes_.color[1]);
    hn::Store(color_.z, kFloats, lanes_.color[2]);
    if constexpr (kFeatures.isosurfaces) {
      hn::Store(value_, kFloats, lanes_.value);
      hn::Store(hn::IfThenElseZero(value_is_stale_, hn::Set(kFloats, 1.0F)), kFloats, lanes_.stale);
    }
  }

  HWY_INLINE void load_lanes() {
    rays_ = Rays(lanes_.rays, 0);
    walk_.rays_changed();
    index_ = hn::Load(kFloats, lanes_.index);
    known_until_ = hn::Load(kFloats, lanes_.known_until);
    alpha_ = hn::Load(kFloats, lanes_.alpha);
    transmittance_ = hn::Sub(hn::Set(kFloats, 1.0F), alpha_);
    color_ = {hn::Load(kFloats, lanes_.color[0]), hn::Load(kFloats, lanes_.color[1]),
              hn::Load(kFloats, lanes_.color[2])};
    if constexpr (kFeatures.isosurfaces) {
      value_ = hn::Load(kFloats, lanes_.value);
      value_is_stale_ = hn::Gt(hn::Load(kFloats, lanes_.stale), hn::Zero(kFloats));
    }
  }

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

  HWY_INLINE Floats value_at(Floats steps) const {
    return field_.value(field_.locate(rays_.at(steps, scene_.field.upper)));
  }

  /// The field in the middle of [begin, end].
  HWY_INLINE Fetched fetch(Floats begin, Floats end) const {
    const Floats3 position = rays_.at(middle(begin, end), scene_.field.upper);
    const auto place = field_.locate(position);
    return {position, place, field_.words(place), hn::Sub(end, begin)};
  }

  /// Emission and absorption of an interval, from the field in its middle.
  HWY_INLINE void add_interval(FloatMask active, const Fetched& fetched) {
    const Floats value = field_.value(fetched.place, fetched.words);
    samples_ += hn::CountTrue(kFloats, active);
    FloatMask seen = active;
    if constexpr (FieldType::kMayBeInfinite) seen = hn::And(active, is_finite(value));
    const Floats usable = hn::IfThenElseZero(seen, value);
    const Floats opacity =
        hn::IfThenElseZero(seen, opacity_of(scene_.transfer, usable, fetched.steps, step_mm_));
    if (hn::AllFalse(kFloats, hn::Gt(opacity, hn::Zero(kFloats)))) return;
    Floats3 color = has_segments(scene_.transfer)
                        ? color_in_segments(scene_.transfer.colors, usable)
                        : look_up(scene_.transfer, usable).color;
    if constexpr (kFeatures.shading) {
      color = shade(scene_.phong, lights_, color, field_.gradient(fetched.place, fetched.words),
                    fetched.position, rays_.direction);
    }
    composite(color, opacity);
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
      if constexpr (kFeatures.dvr) add_interval(hit, fetch(from, until));
      add_surface(hit, until, rising, up, down);
      from = until;
    }
    if constexpr (kFeatures.dvr) add_interval(active, fetch(from, segment.end));
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
  Lanes lanes_;
  Rays rays_;
  CellWalk walk_;
  float step_mm_;

  Floats index_ = hn::Zero(kFloats);        ///< the segment that comes next
  Floats known_until_ = hn::Zero(kFloats);  ///< from this segment on the cells must be asked
  Floats alpha_ = hn::Zero(kFloats);
  Floats transmittance_ = hn::Set(kFloats, 1.0F);  ///< 1 − alpha_
  Floats3 color_{hn::Zero(kFloats), hn::Zero(kFloats), hn::Zero(kFloats)};
  Floats value_ = hn::Zero(kFloats);  ///< of the field where segment index_ begins
  FloatMask value_is_stale_ = hn::MaskFromVec(hn::BitCast(kFloats, hn::Set(kInts, -1)));
  std::uint64_t samples_ = 0;
  FloatMask active_ = hn::Gt(hn::Zero(kFloats), hn::Zero(kFloats));  ///< lanes whose ray goes on
  std::size_t running_ = 0;     ///< lanes that were active when the packet was prepared
  bool holds_results_ = false;  ///< some lane has a ray, maybe ended
};

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
