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
        steps_(rays),
#if HWY_TARGET != HWY_SCALAR
        beam_(rays),
#endif
        alive_(rays.hit()),
        wanted_(alive_),
        present_(alive_) {
  }

  /// Returns how many samples were taken.
  HWY_INLINE std::uint64_t run() {
    while (!hn::AllFalse(kFloats, alive_)) {
      // Which rays have ended is asked one run late: to know it now would mean to wait for the last
      // sample's opacity.
      const FloatMask before = alive_;
      const int known = next_visible();
      if (known == 0) break;
      if (const int whole = steps_.whole(); whole > 0) {
        present_ = rays_.hit();
        take_whole(std::min(known, whole));
      } else {
        take_parts(std::min(known, steps_.until_whole()));
      }
      wanted_ = before;
    }
    return samples_;
  }

  /// Rays bring what they have gathered in the slabs before.
  HWY_INLINE void resume(const Floats3& color, Floats alpha) {
    sum_.resume(color, alpha);
    alive_ = hn::And(alive_, sum_.is_open());
    wanted_ = alive_;
  }

  HWY_INLINE const Accumulation& sum() const { return sum_; }

 private:
  /// Goes on to the next step in which any ray may see something. Returns how many steps to take
  /// before the cells are asked again: as many as is known on average, for what is sampled beyond
  /// adds exactly 0 if it is empty. 0 when all rays have ended.
  HWY_INLINE int next_visible() {
    while (!steps_.ended()) {
      const Floats index = steps_.index();
      const Segment segment = segment_of(rays_, index);
      const Floats middle_of = middle(segment.begin, segment.end);
      const auto cube = walk_.look(rays_.at(middle_of, scene_.field), middle_of);
      const FloatMask inside = hn::And(wanted_, steps_.inside());
      const FloatMask visible = hn::And(inside, cube.visible);
      const Floats known = hn::Sub(segment_after(index, cube.exit), index);
      if (!hn::AllFalse(kFloats, visible)) return PacketSteps::average(visible, known);
      steps_.leap(wanted_, known);
    }
    return 0;
  }

  /// Of the whole segment `ahead` of the next one.
  HWY_INLINE Floats3 middle_of_whole(int ahead) const {
    const Floats steps = hn::Add(steps_.index(), hn::Set(kFloats, 0.5F + float(ahead)));
    return rays_.at(steps, scene_.field);
  }

  /// The next steps, in which all rays have whole segments.
  HWY_INLINE void take_whole(int steps) {
#if HWY_TARGET != HWY_SCALAR
    // Several samples at a time: what they wait for is not each other.
    const float first = steps_.step(), last = first + float(steps - 1);
    if (steps >= kTogether && beam_.is_narrow(first, last, kTogether, FieldType::kBeamEdges)) {
      for (; steps >= kTogether && !hn::AllFalse(kFloats, alive_); steps -= kTogether)
        add_whole<kTogether, false>();
    } else if (beam_.is_wide(first, last, FieldType::kMostEdges)) {
      for (; steps >= kTogether && !hn::AllFalse(kFloats, alive_); steps -= kTogether)
        add_whole<kTogether, true>();
    }
#endif
    for (; steps > 0 && !hn::AllFalse(kFloats, alive_); --steps) {
      const Floats3 position = middle_of_whole(0);
      const CellPlace place = locate(position);
      Floats value = field_.value(place, present_);
      const FloatMask finite = FieldType::take_finite(value);
      add(hn::And(present_, finite), place, position, look_at(scene_.transfer, value));
      steps_.advance(1);
    }
  }
  static constexpr int kTogether = 3;
  static constexpr int kAhead = 12;

#if HWY_TARGET != HWY_SCALAR
  template <int kCount, bool kApart>
  HWY_INLINE void add_whole() {
    CellPlace places[kCount];
    Floats3 positions[kCount];
    GOLDTHREAD_UNROLL
    for (int i = 0; i < kCount; ++i) {
      positions[i] = middle_of_whole(i);
      places[i] = locate(positions[i]);
    }
    Floats values[kCount];
    if constexpr (kApart) {
      field_.values_apart(places, locate(middle_of_whole(kAhead)), hn::And(present_, wanted_),
                          values);
    } else {
      field_.values(beam_, steps_.step(), places, present_, values);
    }
    FloatMask finite[kCount];
    Look looks[kCount];
    GOLDTHREAD_UNROLL
    for (int i = 0; i < kCount; ++i) {
      finite[i] = FieldType::take_finite(values[i]);
      looks[i] = look_at(scene_.transfer, values[i]);
    }
    GOLDTHREAD_UNROLL
    for (int i = 0; i < kCount; ++i)
      add(hn::And(present_, finite[i]), places[i], positions[i], looks[i]);
    steps_.advance(float(kCount));
  }
#endif

  /// The next steps, with the part of its segment that each ray has inside the volume.
  HWY_INLINE void take_parts(int steps) {
    for (; steps > 0 && !hn::AllFalse(kFloats, alive_); --steps) {
      const Segment segment = segment_of(rays_, steps_.index());
      const Floats3 position = rays_.at(middle(segment.begin, segment.end), scene_.field);
      const CellPlace place = locate(position);
      const FloatMask inside = steps_.inside();
      Floats value = field_.value(place, inside);
      const FloatMask finite = FieldType::take_finite(value);
      add(hn::And(inside, finite), place, position,
          look_at(scene_.transfer, value, hn::Sub(segment.end, segment.begin), step_mm_));
      steps_.advance(1);
    }
  }

  /// Nothing but the sums waits for the opacity of the samples before: these are far behind when
  /// the next samples are begun.
  HWY_INLINE void add(FloatMask seen, const CellPlace& place, const Floats3& position, Look look) {
    samples_ += hn::CountTrue(kFloats, alive_);
    seen = hn::And(seen, alive_);
    if constexpr (kShading) {
      const FloatMask visible = hn::And(seen, hn::Gt(look.opacity, hn::Zero(kFloats)));
      if (hn::AllFalse(kFloats, visible)) return;
      look.color = shading_.shade(look.color, field_.gradient(place, visible), position);
    }
    sum_.add(look.color, hn::IfThenElseZero(seen, look.opacity));
    alive_ = hn::And(alive_, sum_.is_open());
  }

  using FieldType = Field<kStorage, kShading>;

  const KernelScene& scene_;
  FieldType field_;
  const Rays& rays_;
  CellWalk walk_;
  PhongShading shading_;
  float step_mm_;

  PacketSteps steps_;
#if HWY_TARGET != HWY_SCALAR
  Beam beam_;
#endif
  FloatMask alive_;    ///< rays whose transmittance has not run out
  FloatMask wanted_;   ///< those of the run before
  FloatMask present_;  ///< rays inside the volume
  Accumulation sum_;
  std::uint64_t samples_ = 0;
};

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
