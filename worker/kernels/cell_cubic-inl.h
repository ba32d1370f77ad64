// SPDX-License-Identifier: Apache-2.0
// The field along a ray inside one cell of 2³ voxels: a cubic, exactly. Where it turns and where it
// takes a value: split at the roots of its derivative, then bracketed (Marmitt et al. 2004). The
// ray is re-origined at its entry into the cell, so that no digits are lost to where it comes from.

#if defined(GOLDTHREAD_WORKER_KERNELS_CELL_CUBIC_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_CELL_CUBIC_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_CELL_CUBIC_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_CELL_CUBIC_INL_H_
#endif

#include "worker/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

class CellCubic {
 public:
  /// `corners` x fastest, then y, then z; `entry` is where the ray enters, in the cell's own
  /// coordinates, and `chord` where it leaves less where it enters. The field is then base() +
  /// rise(s), s from 0 to 1 along the chord.
  HWY_INLINE CellCubic(const Floats (&corners)[8], const Floats3& entry, const Floats3& chord) {
    const Floats k = corners[0];
    const Floats kx = hn::Sub(corners[1], k), ky = hn::Sub(corners[2], k);
    const Floats kz = hn::Sub(corners[4], k);
    const Floats kxy = hn::Sub(hn::Sub(corners[3], corners[2]), kx);
    const Floats kxz = hn::Sub(hn::Sub(corners[5], corners[4]), kx);
    const Floats kyz = hn::Sub(hn::Sub(corners[6], corners[4]), ky);
    const Floats kxyz =
        hn::Sub(hn::Sub(hn::Sub(corners[7], corners[6]), hn::Sub(corners[5], corners[4])), kxy);
    const Floats u = entry.x, v = entry.y, w = entry.z;
    const Floats dx = chord.x, dy = chord.y, dz = chord.z;
    // Derivatives at the entry: f = Σ of products, each factor a line in s.
    const Floats along_x = hn::MulAdd(hn::MulAdd(kxyz, w, kxy), v, hn::MulAdd(kxz, w, kx));
    const Floats along_y = hn::MulAdd(hn::MulAdd(kxyz, w, kxy), u, hn::MulAdd(kyz, w, ky));
    const Floats along_z = hn::MulAdd(hn::MulAdd(kxyz, v, kxz), u, hn::MulAdd(kyz, v, kz));
    const Floats mixed_xy = hn::MulAdd(kxyz, w, kxy);
    const Floats mixed_xz = hn::MulAdd(kxyz, v, kxz);
    const Floats mixed_yz = hn::MulAdd(kxyz, u, kyz);
    base_ = k;
    c0_ = hn::MulAdd(along_x, u, hn::MulAdd(hn::MulAdd(kyz, w, ky), v, hn::Mul(kz, w)));
    c1_ = hn::MulAdd(along_x, dx, hn::MulAdd(along_y, dy, hn::Mul(along_z, dz)));
    c2_ = hn::MulAdd(hn::Mul(mixed_xy, dx), dy,
                     hn::MulAdd(hn::Mul(mixed_xz, dx), dz, hn::Mul(hn::Mul(mixed_yz, dy), dz)));
    c3_ = hn::Mul(hn::Mul(kxyz, dx), hn::Mul(dy, dz));
  }

  HWY_INLINE Floats base() const { return base_; }
  HWY_INLINE Floats rise(Floats s) const {
    return hn::MulAdd(hn::MulAdd(hn::MulAdd(c3_, s, c2_), s, c1_), s, c0_);
  }
  HWY_INLINE Floats slope(Floats s) const {
    const Floats two_c2 = hn::Add(c2_, c2_);
    const Floats three_c3 = hn::MulAdd(hn::Set(kFloats, 2.0F), c3_, c3_);
    return hn::MulAdd(hn::MulAdd(three_c3, s, two_c2), s, c1_);
  }

  /// Where the field may turn, in ascending order, moved into [0, 1].
  struct Turns {
    Floats first, second;
  };
  HWY_INLINE Turns turns() const {
    const Floats zero = hn::Zero(kFloats), one = hn::Set(kFloats, 1.0F);
    const Floats a = hn::Mul(hn::Set(kFloats, 3.0F), c3_);
    const Floats discriminant = hn::NegMulAdd(a, c1_, hn::Mul(c2_, c2_));
    const Floats root = hn::Sqrt(hn::Max(discriminant, zero));
    const Floats q = hn::Neg(hn::Add(c2_, hn::CopySign(root, c2_)));
    // 0/0 and x/0 are no turns: what is not inside is moved to the start.
    const auto inside = [&](Floats s) HWY_ATTR {
      const auto usable = hn::And(hn::Gt(s, zero), hn::Lt(s, one));
      return hn::IfThenElseZero(hn::And(usable, hn::Ge(discriminant, zero)), s);
    };
    const Floats s1 = inside(hn::Div(q, a)), s2 = inside(hn::Div(c1_, q));
    return {hn::Min(s1, s2), hn::Max(s1, s2)};
  }

  /// The greatest value on the chord.
  HWY_INLINE Floats greatest() const {
    const Turns turn = turns();
    const Floats at_ends = hn::Max(rise(hn::Zero(kFloats)), rise(hn::Set(kFloats, 1.0F)));
    return hn::Add(base_, hn::Max(at_ends, hn::Max(rise(turn.first), rise(turn.second))));
  }

  /// Where base() + rise() is `value`, between two places on whose sides it differs; the field must
  /// be monotone there. Newton's method inside a bracket, halving where it would leave it.
  HWY_INLINE Floats solve(Floats value, Floats begin, Floats end, FloatMask wanted) const {
    constexpr int kMostRounds = 40;
    const Floats half = hn::Set(kFloats, 0.5F), tolerance = hn::Set(kFloats, 1e-7F);
    const Floats level = hn::Sub(base_, value);
    const auto rising = hn::Lt(rise(begin), rise(end));
    Floats below = hn::IfThenElse(rising, begin, end);
    Floats above = hn::IfThenElse(rising, end, begin);
    Floats s = hn::Mul(half, hn::Add(begin, end));
    Floats previous = hn::Abs(hn::Sub(end, begin));
    // A lane that has come to its end stays there, whatever its company still needs.
    FloatMask open = wanted;
    for (int round = 0; round < kMostRounds && !hn::AllFalse(kFloats, open); ++round) {
      const Floats f = hn::Add(level, rise(s));
      const auto is_below = hn::Lt(f, hn::Zero(kFloats));
      below = hn::IfThenElse(is_below, s, below);
      above = hn::IfThenElse(is_below, above, s);
      const Floats newton = hn::Sub(s, hn::Div(f, slope(s)));
      const Floats low = hn::Min(below, above), high = hn::Max(below, above);
      const Floats change = hn::Abs(hn::Sub(newton, s));
      // Written so that NaN halves.
      const auto good = hn::And(hn::And(hn::Ge(newton, low), hn::Le(newton, high)),
                                hn::Le(hn::Add(change, change), previous));
      const Floats next = hn::IfThenElse(good, newton, hn::Mul(half, hn::Add(low, high)));
      previous = hn::Abs(hn::Sub(next, s));
      s = hn::IfThenElse(open, next, s);
      open = hn::And(open, hn::Gt(previous, tolerance));
    }
    return s;
  }

 private:
  Floats base_;               ///< the field at the cell's lower corner
  Floats c0_, c1_, c2_, c3_;  ///< of what it rises by from there
};

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
