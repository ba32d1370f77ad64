// SPDX-License-Identifier: Apache-2.0
// What a packet's rays have gathered so far, front to back.

#if defined(GOLDTHREAD_WORKER_KERNELS_ACCUMULATION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_ACCUMULATION_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_ACCUMULATION_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_ACCUMULATION_INL_H_
#endif

#include "worker/kernels/kernel_types.h"
#include "worker/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

class Accumulation {
 public:
  // Not left to the compiler: its own would lack the target's instructions.
  HWY_INLINE Accumulation()
      : color_{hn::Zero(kFloats), hn::Zero(kFloats), hn::Zero(kFloats)},
        alpha_(hn::Zero(kFloats)),
        transmittance_(hn::Set(kFloats, 1.0F)) {}

  /// Goes on with what sums() was elsewhere.
  HWY_INLINE void resume(const Floats3& color, Floats alpha) {
    color_ = color;
    alpha_ = alpha;
    transmittance_ = hn::Sub(hn::Set(kFloats, 1.0F), alpha_);
  }

  /// Adds what is behind all so far; colour not multiplied by opacity.
  HWY_INLINE void add(const Floats3& color, Floats opacity) {
    const Floats weight = hn::Mul(transmittance_, opacity);
    color_.x = hn::MulAdd(weight, color.x, color_.x);
    color_.y = hn::MulAdd(weight, color.y, color_.y);
    color_.z = hn::MulAdd(weight, color.z, color_.z);
    // Opacity is summed up, not transmittance taken down: what is thin keeps its digits.
    alpha_ = hn::Add(alpha_, weight);
    transmittance_ = hn::Sub(hn::Set(kFloats, 1.0F), alpha_);
  }

  /// Whether what lies behind could still be seen.
  HWY_INLINE FloatMask is_open() const {
    return hn::Gt(transmittance_, hn::Set(kFloats, kLeastTransmittance));
  }

  /// As it is, to go on with.
  HWY_INLINE Floats3 color_so_far() const { return color_; }
  HWY_INLINE Floats alpha_so_far() const { return alpha_; }

  HWY_INLINE Floats3 color() const {
    const Floats share = closing_share();
    return {hn::Mul(color_.x, share), hn::Mul(color_.y, share), hn::Mul(color_.z, share)};
  }
  HWY_INLINE Floats alpha() const {
    return hn::IfThenElse(is_open(), alpha_, hn::Set(kFloats, 1.0F));
  }

 private:
  /// A ray that has ended stands for what it would still have met.
  HWY_INLINE Floats closing_share() const {
    const Floats one = hn::Set(kFloats, 1.0F);
    return hn::Div(one, hn::IfThenElse(is_open(), one, alpha_));
  }

  Floats3 color_;
  Floats alpha_;
  Floats transmittance_;  ///< 1 − alpha_
};

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
