// SPDX-License-Identifier: Apache-2.0
// The kernel for isosurfaces, alone or inside a translucent volume. Each ray goes from cell of 2³
// voxels to cell; in each the field along the ray is a cubic, whose crossings are found exactly and
// in order. Emission and absorption is integrated over the same segments as without surfaces, cut
// where a surface lies.

#if defined(GOLDTHREAD_WORKER_KERNELS_SURFACE_MARCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_SURFACE_MARCH_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_SURFACE_MARCH_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_SURFACE_MARCH_INL_H_
#endif

#include "worker/kernels/accumulation-inl.h"
#include "worker/kernels/cell_cubic-inl.h"
#include "worker/kernels/cell_walk-inl.h"
#include "worker/kernels/field-inl.h"
#include "worker/kernels/ray_packet-inl.h"
#include "worker/kernels/shading-inl.h"
#include "worker/kernels/transfer-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

template <Storage kStorage, bool kDvr, bool kShading>
class SurfaceMarch {
 public:
  HWY_INLINE SurfaceMarch(const CastArguments& arguments, const Rays& rays, const FineRays& fine)
      : scene_(arguments.scene),
        field_(arguments.scene.field),
        rays_(rays),
        fine_(fine),
        walk_(arguments.scene, rays_),
        shading_(arguments.scene.phong, arguments.view.lights, rays.direction),
        step_mm_(float(arguments.scene.step_mm)),
        per_step_{inverse(rays.direction.x), inverse(rays.direction.y), inverse(rays.direction.z)},
        company_(company_of(rays)),
        alive_(rays.hit()),
        at_(rays.first),
        integrated_(rays.first) {}

  /// Returns how many samples were taken: cells visited, and those of emission and absorption.
  HWY_INLINE std::uint64_t run() {
    enter(alive_);
    enter_midway();
    while (!hn::AllFalse(kFloats, alive_)) {
      look();
      if (hn::AllFalse(kFloats, alive_)) break;
      visit(near_the_last());
    }
    return samples_;
  }

  /// Rays bring what they have gathered in the slabs before.
  HWY_INLINE void resume(const Floats3& color, Floats alpha, Unsigneds met) {
    sum_.resume(color, alpha);
    met_ = met;
    alive_ = hn::And(alive_, sum_.is_open());
  }

  HWY_INLINE const Accumulation& sum() const { return sum_; }
  /// The surfaces that each ray met, in their order, as a number in a system whose digits are 1 …
  /// number of surfaces: no two sequences share one before 32 bits overflow.
  HWY_INLINE Unsigneds met() const { return met_; }

 private:
  static HWY_INLINE Floats inverse(Floats direction) {
    const auto moves = hn::Gt(hn::Abs(direction), hn::Set(kFloats, 1e-20F));
    const Floats one = hn::Set(kFloats, 1.0F);
    return hn::IfThenElse(moves, hn::Div(one, hn::IfThenElse(moves, direction, one)),
                          hn::Set(kFloats, std::numeric_limits<float>::infinity()));
  }

  /// The rays that have come least far, and those close to them: a packet keeps together, so that
  /// its voxels lie in one window. All rays, where none would hold them anyway.
  HWY_INLINE FloatMask near_the_last() const {
    const Floats far = hn::Set(kFloats, 1e30F);
    const Floats way = hn::Add(at_, rays_.delay);
    const Floats least = hn::MinOfLanes(kFloats, hn::IfThenElse(alive_, way, far));
    return hn::And(alive_, hn::Le(way, hn::Add(least, hn::Set(kFloats, company_))));
  }
  static HWY_INLINE float company_of([[maybe_unused]] const Rays& rays) {
#if HWY_TARGET != HWY_SCALAR
    if (Beam(rays).is_wide(0, 0, FieldType::kMostEdges)) return 1e9F;
#endif
    return 4;
  }

  /// Puts rays into the cells around where they are.
  HWY_INLINE void enter(FloatMask lanes) {
    const Floats3 position = rays_.at(at_, scene_.field);
    const auto put = [&](Floats cell, Floats p)
                         HWY_ATTR { return hn::IfThenElse(lanes, hn::Floor(p), cell); };
    cell_ = {put(cell_.x, position.x), put(cell_.y, position.y), put(cell_.z, position.z)};
    value_is_stale_ = hn::Or(value_is_stale_, lanes);
  }

  /// Rays that come from another slab begin where they entered the cell in which they are handed
  /// over, or the one before: what they meet in it is found as in the whole volume, and counts in
  /// the slab whose segment it lies in.
  HWY_INLINE void enter_midway() {
    const FloatMask midway = hn::And(alive_, hn::Gt(rays_.begin, hn::Zero(kFloats)));
    if (hn::AllFalse(kFloats, midway)) return;
    const Floats back =
        hn::MulAdd(rays_.begin, hn::Set(kFloats, 1.0F - 1e-6F), hn::Set(kFloats, -0.01F));
    integrated_ = hn::IfThenElse(midway, hn::Max(integrated_, rays_.begin), integrated_);
    at_ = hn::IfThenElse(midway, hn::Max(rays_.first, back), at_);
    enter(midway);
    const Floats3 behind = hits_of_faces(/*ahead=*/false);
    const Floats entry = hn::Max(behind.x, hn::Max(behind.y, behind.z));
    at_ = hn::IfThenElse(midway, hn::Max(rays_.first, entry), at_);
  }

  /// Takes rays that are about to enter the unknown over what is empty.
  HWY_INLINE void look() {
    while (true) {
      const FloatMask unsure = hn::And(alive_, hn::Ge(at_, known_until_));
      if (hn::AllFalse(kFloats, unsure)) return;
      const auto cube = walk_.look(rays_.at(at_, scene_.field), at_);
      const FloatMask gains = hn::Gt(cube.exit, hn::Add(at_, hn::Set(kFloats, 1.0F)));
      const FloatMask leaps = hn::And(unsure, hn::AndNot(cube.visible, gains));
      // The last bit of the empty cube is gone through cell by cell: its end is known to rounding.
      const Floats sure = hn::Add(cube.exit, hn::Set(kFloats, 0.01F));
      const Floats until =
          hn::IfThenElse(leaps, sure, hn::IfThenElse(cube.visible, cube.exit, at_));
      known_until_ = hn::IfThenElse(unsure, hn::Max(until, hn::Add(at_, hn::Set(kFloats, 1e-3F))),
                                    known_until_);
      if (hn::AllFalse(kFloats, leaps)) return;
      if constexpr (kDvr) {
        // What was begun before the empty cube is finished: its segment may end inside.
        const Floats begun = hn::Add(hn::Floor(integrated_), hn::Set(kFloats, 1.0F));
        const FloatMask open = hn::And(leaps, hn::Lt(integrated_, at_));
        integrate(open, hn::Min(begun, rays_.last), /*to_the_end=*/true);
      }
      at_ = hn::IfThenElse(leaps, hn::Min(cube.exit, rays_.last), at_);
      // On with whole segments: what is integrated does not depend on how far a leap went.
      integrated_ = hn::IfThenElse(leaps, hn::Max(integrated_, hn::Floor(at_)), integrated_);
      alive_ = hn::And(alive_, hn::Lt(at_, hn::Min(rays_.last, rays_.until)));
      enter(leaps);
    }
  }

  /// The cell that each of `lanes` is in, and on to the next one.
  HWY_INLINE void visit(FloatMask lanes) {
    const Floats3 ahead = hits_of_faces(/*ahead=*/true);
    const Floats exit =
        hn::Max(at_, hn::Min(hn::Min(ahead.x, ahead.y), hn::Min(ahead.z, rays_.last)));
    Floats corners[8];
    field_.cell(cell_place(cell_, Floats3{}), lanes, corners);
    samples_ += hn::CountTrue(kFloats, lanes);
    const FloatMask finite = hn::And(lanes, are_finite(corners));
    const FloatMask crossing = hn::And(finite, may_cross(corners));
    if (!hn::AllFalse(kFloats, crossing)) cross(crossing, corners, exit);
    // Where nothing is crossed any value of the cell lies on the same side as its end.
    const FloatMask passed = hn::AndNot(crossing, finite);
    value_ = hn::IfThenElse(passed, corners[0], value_);
    value_is_stale_ = hn::AndNot(lanes, value_is_stale_);
    value_is_stale_ = hn::Or(value_is_stale_, hn::AndNot(finite, lanes));
    const Floats last = hn::Min(rays_.last, rays_.until);
    if constexpr (kDvr) integrate(lanes, hn::Min(exit, last), /*to_the_end=*/false);
    const FloatMask stays = step_over(lanes, ahead, exit);
    const FloatMask ends = hn::AndNot(hn::And(stays, hn::Lt(exit, last)), lanes);
    if constexpr (kDvr) {
      if (!hn::AllFalse(kFloats, ends)) integrate(ends, last, /*to_the_end=*/true);
    }
    alive_ = hn::And(hn::AndNot(ends, alive_), sum_.is_open());
  }

  /// Where the rays meet the faces of their cells, `ahead` or behind, in steps.
  HWY_INLINE Floats3 hits_of_faces(bool ahead) const {
    const Floats in_front = hn::Set(kFloats, ahead ? 1.0F : 0.0F);
    const Floats at_back = hn::Set(kFloats, ahead ? 0.0F : 1.0F);
    const Floats never = hn::Set(kFloats, ahead ? 1e30F : -1e30F);
    const auto along = [&](Floats cell, Floats start, Floats direction, Floats per_step) HWY_ATTR {
      const auto forward = hn::Gt(direction, hn::Zero(kFloats));
      const Floats face = hn::Add(cell, hn::IfThenElse(forward, in_front, at_back));
      const Floats steps = hn::Mul(hn::Sub(face, start), per_step);
      // 0·∞: a ray in a face that it is parallel to never meets it.
      return hn::IfThenElse(hn::Lt(hn::Abs(per_step), hn::Set(kFloats, 1e20F)), steps, never);
    };
    return {along(cell_.x, rays_.start.x, rays_.direction.x, per_step_.x),
            along(cell_.y, rays_.start.y, rays_.direction.y, per_step_.y),
            along(cell_.z, rays_.start.z, rays_.direction.z, per_step_.z)};
  }

  /// Into the next cells; false where there is none.
  HWY_INLINE FloatMask step_over(FloatMask lanes, const Floats3& ahead, Floats exit) {
    at_ = hn::IfThenElse(lanes, exit, at_);
    FloatMask stays = lanes;
    const auto step = [&](Floats cell, Floats face, Floats direction, int axis) HWY_ATTR {
      const auto crosses = hn::And(lanes, hn::Le(face, exit));
      const Floats way = hn::CopySign(hn::Set(kFloats, 1.0F), direction);
      const Floats next = hn::Add(cell, hn::IfThenElseZero(crosses, way));
      const Floats most = hn::Set(kFloats, float(scene_.field.size[axis] - 2));
      const Floats inside = hn::Min(hn::Max(next, hn::Zero(kFloats)), most);
      stays = hn::And(stays, hn::Eq(next, inside));
      return inside;
    };
    cell_ = {step(cell_.x, ahead.x, rays_.direction.x, 0),
             step(cell_.y, ahead.y, rays_.direction.y, 1),
             step(cell_.z, ahead.z, rays_.direction.z, 2)};
    return stays;
  }

  static HWY_INLINE CellPlace cell_place(const Floats3& cell, const Floats3& fraction) {
    return {{truncated(cell.x), truncated(cell.y), truncated(cell.z)},
            fraction.x,
            fraction.y,
            fraction.z};
  }

  static HWY_INLINE FloatMask are_finite(const Floats (&corners)[8]) {
    if constexpr (!FieldType::kMayBeInfinite) return hn::Ge(corners[0], hn::Zero(kFloats));
    FloatMask finite = is_finite(corners[0]);
    for (int i = 1; i < 8; ++i) finite = hn::And(finite, is_finite(corners[i]));
    return finite;
  }

  /// Whether an isovalue lies between the corners' least and greatest value, or between them and
  /// where the ray comes from.
  HWY_INLINE FloatMask may_cross(const Floats (&corners)[8]) const {
    Floats least = hn::IfThenElse(value_is_stale_, corners[0], value_), greatest = least;
    for (const Floats& corner : corners) {
      least = hn::Min(least, corner);
      greatest = hn::Max(greatest, corner);
    }
    FloatMask any = hn::Gt(hn::Zero(kFloats), hn::Zero(kFloats));
    for (const SurfaceTerm& surface : scene_.surfaces) {
      const Floats isovalue = hn::Set(kFloats, surface.value);
      any = hn::Or(any, hn::And(hn::Le(least, isovalue), hn::Le(isovalue, greatest)));
    }
    return any;
  }

  /// Goes through the surfaces of a cell: in each of the three parts in which the field is
  /// monotone, in the order in which it meets their values.
  HWY_INLINE void cross(FloatMask lanes, const Floats (&corners)[8], Floats exit) {
    const Floats3 entry = fine_.inside(rays_, cell_, at_);
    const Floats length = hn::Sub(exit, at_);
    const Floats3 chord{hn::Mul(length, rays_.direction.x), hn::Mul(length, rays_.direction.y),
                        hn::Mul(length, rays_.direction.z)};
    const CellCubic cubic(corners, entry, chord);
    const auto turns = cubic.turns();
    const Floats ends[4] = {hn::Zero(kFloats), turns.first, turns.second, hn::Set(kFloats, 1.0F)};
    Floats value =
        hn::IfThenElse(value_is_stale_, hn::Add(cubic.base(), cubic.rise(ends[0])), value_);
    for (int part = 0; part < 3; ++part) {
      // A part without length has nothing to cross: rounding at a face must not count as one.
      const auto none = hn::Eq(ends[part + 1], ends[part]);
      const Floats next =
          hn::IfThenElse(none, value, hn::Add(cubic.base(), cubic.rise(ends[part + 1])));
      const FloatMask rising = hn::Lt(value, next);
      const std::size_t count = scene_.surfaces.size();
      for (std::size_t i = 0; i < count; ++i) {
        const SurfaceTerm& up = scene_.surfaces[i];
        const SurfaceTerm& down = scene_.surfaces[count - 1 - i];
        const Floats isovalue =
            hn::IfThenElse(rising, hn::Set(kFloats, up.value), hn::Set(kFloats, down.value));
        const FloatMask hit = hn::And(hn::And(lanes, sum_.is_open()),
                                      hn::Xor(hn::Lt(value, isovalue), hn::Lt(next, isovalue)));
        if (hn::AllFalse(kFloats, hit)) continue;
        const Floats s = cubic.solve(isovalue, ends[part], ends[part + 1], hit);
        const Floats where = hn::MulAdd(s, length, at_);
        const FloatMask own = hn::And(hit, is_own(where));
        if (hn::AllFalse(kFloats, own)) continue;
        if constexpr (kDvr) integrate(own, where, /*to_the_end=*/true);
        // What lies before it may have been the last that a ray can see.
        const FloatMask seen = hn::And(own, sum_.is_open());
        const Floats3 fraction{hn::MulAdd(s, chord.x, entry.x), hn::MulAdd(s, chord.y, entry.y),
                               hn::MulAdd(s, chord.z, entry.z)};
        add_surface(seen, fraction, rising, up, down);
        remember(seen, rising, std::uint32_t(i), std::uint32_t(count));
      }
      value = next;
    }
    value_ = hn::IfThenElse(lanes, value, value_);
  }

  /// Whether a place of the ray lies in one of the slab's segments.
  HWY_INLINE FloatMask is_own(Floats steps) const {
    const FloatMask after =
        hn::Or(hn::Eq(rays_.begin, hn::Zero(kFloats)), hn::Ge(steps, rays_.begin));
    return hn::And(after, hn::Lt(steps, rays_.until));
  }

  /// Emission and absorption from where it has come to, in whole segments, and to_the_end in what
  /// is left before `limit` as well.
  HWY_INLINE void integrate(FloatMask lanes, Floats limit, bool to_the_end) {
    while (true) {
      const Floats whole = hn::Add(hn::Floor(integrated_), hn::Set(kFloats, 1.0F));
      const Floats end = hn::Min(whole, limit);
      FloatMask wanted = hn::And(lanes, hn::Lt(integrated_, end));
      if (!to_the_end) wanted = hn::And(wanted, hn::Le(whole, limit));
      if (hn::AllFalse(kFloats, wanted)) return;
      add_interval(wanted, integrated_, end);
      integrated_ = hn::IfThenElse(wanted, end, integrated_);
    }
  }

  HWY_INLINE void add_interval(FloatMask sampled, Floats begin, Floats end) {
    const Floats3 position = rays_.at(middle(begin, end), scene_.field);
    const CellPlace place = locate(position);
    Floats value = field_.value(place, sampled);
    const FloatMask finite = FieldType::take_finite(value);
    samples_ += hn::CountTrue(kFloats, sampled);
    const FloatMask seen = hn::And(hn::And(sampled, sum_.is_open()), finite);
    Look look = look_at(scene_.transfer, value, hn::Sub(end, begin), step_mm_);
    const FloatMask visible = hn::And(seen, hn::Gt(look.opacity, hn::Zero(kFloats)));
    if (hn::AllFalse(kFloats, visible)) return;
    if constexpr (kShading)
      look.color = shading_.shade(look.color, field_.gradient(place, visible), position);
    sum_.add(look.color, hn::IfThenElseZero(visible, look.opacity));
  }

  HWY_INLINE void add_surface(FloatMask hit, const Floats3& fraction, FloatMask rising,
                              const SurfaceTerm& up, const SurfaceTerm& down) {
    const auto chosen = [&](float a, float b) HWY_ATTR {
      return hn::IfThenElse(rising, hn::Set(kFloats, a), hn::Set(kFloats, b));
    };
    Floats3 color{chosen(up.color[0], down.color[0]), chosen(up.color[1], down.color[1]),
                  chosen(up.color[2], down.color[2])};
    if constexpr (kShading) {
      const Floats3 position{hn::Add(cell_.x, fraction.x), hn::Add(cell_.y, fraction.y),
                             hn::Add(cell_.z, fraction.z)};
      color = shading_.shade(color, field_.gradient(cell_place(cell_, fraction), hit), position);
    }
    sum_.add(color, hn::IfThenElseZero(hit, chosen(up.opacity, down.opacity)));
  }

  /// Surface number `up` of `count` where the field rises, number `up` from the end where it falls.
  HWY_INLINE void remember(FloatMask hit, FloatMask rising, std::uint32_t up, std::uint32_t count) {
    const Unsigneds digit =
        hn::IfThenElse(hn::RebindMask(kUnsigned, rising), hn::Set(kUnsigned, up + 1),
                       hn::Set(kUnsigned, count - up));
    // The base is odd, so that what overflows leaves its mark below.
    const Unsigneds more = hn::Add(hn::Mul(met_, hn::Set(kUnsigned, count | 3U)), digit);
    met_ = hn::IfThenElse(hn::RebindMask(kUnsigned, hit), more, met_);
  }

  using FieldType = Field<kStorage, kShading>;

  const KernelScene& scene_;
  FieldType field_;
  const Rays& rays_;
  const FineRays& fine_;
  CellWalk walk_;
  PhongShading shading_;
  float step_mm_;
  Floats3 per_step_;  ///< 1 / direction

  float company_;  ///< how far rays may be from each other to go on together, in steps

  FloatMask alive_;
  Floats at_;          ///< where the ray enters its cell, in steps
  Floats integrated_;  ///< how far emission and absorption has been integrated
  Floats3 cell_{hn::Zero(kFloats), hn::Zero(kFloats), hn::Zero(kFloats)};  ///< lower corner
  Floats known_until_ = hn::Zero(kFloats);  ///< from here on the cells must be asked
  Floats value_ = hn::Zero(kFloats);        ///< of the field at at_
  FloatMask value_is_stale_ = hn::Ge(hn::Zero(kFloats), hn::Zero(kFloats));
  Accumulation sum_;
  Unsigneds met_ = hn::Zero(kUnsigned);
  std::uint64_t samples_ = 0;
};

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
