// SPDX-License-Identifier: Apache-2.0
// Names for the vectors of a kernel, and the few functions that Highway does not have.

#if defined(GOLDTHREAD_WORKER_KERNELS_VECTOR_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_VECTOR_MATH_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_VECTOR_MATH_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_VECTOR_MATH_INL_H_
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

// Loops over a few vectors must not become loops over memory.
#ifndef GOLDTHREAD_UNROLL
#define GOLDTHREAD_UNROLL _Pragma("GCC unroll 8")
#endif

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::ScalableTag<float>;
using IntTag = hn::RebindToSigned<FloatTag>;
using UnsignedTag = hn::RebindToUnsigned<FloatTag>;
using Floats = hn::Vec<FloatTag>;
using Ints = hn::Vec<IntTag>;
using Unsigneds = hn::Vec<UnsignedTag>;
using FloatMask = hn::Mask<FloatTag>;

constexpr FloatTag kFloats{};
constexpr IntTag kInts{};
constexpr UnsignedTag kUnsigned{};

struct Floats3 {
  Floats x, y, z;
};

/// `v`, of which the compiler may assume nothing: a constant would be made anew in each loop, from
/// a general register, where loading it costs less.
HWY_INLINE std::int32_t unknown(std::int32_t v) {
  asm("" : "+r"(v));
  return v;
}

/// Towards 0, for numbers that an int32 can hold; others are unspecified but harmless.
HWY_INLINE Ints truncated(Floats v) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  return Ints{_mm512_cvttps_epi32(v.raw)};
#elif HWY_TARGET == HWY_AVX2
  return Ints{_mm256_cvttps_epi32(v.raw)};
#else
  return hn::ConvertTo(kInts, v);
#endif
}

HWY_INLINE Floats lerp(Floats a, Floats b, Floats fraction) {
  return hn::MulAdd(fraction, hn::Sub(b, a), a);
}

HWY_INLINE Floats dot(const Floats3& a, const Floats3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

/// matrix·v, the matrix row by row.
HWY_INLINE Floats3 transform(const float* matrix, const Floats3& v) {
  const auto row = [&](const float* m) HWY_ATTR {
    return hn::MulAdd(
        hn::Set(kFloats, m[0]), v.x,
        hn::MulAdd(hn::Set(kFloats, m[1]), v.y, hn::Mul(hn::Set(kFloats, m[2]), v.z)));
  };
  return {row(matrix), row(matrix + 3), row(matrix + 6)};
}

/// 1 − e^−x for x ≥ 0, to 2 ulp relative to the result: small optical depths keep their digits.
HWY_INLINE Floats one_minus_exp(Floats x) {
  const Floats depth = hn::Min(x, hn::Set(kFloats, 80.0F));
  const Floats n = hn::Round(hn::Mul(depth, hn::Set(kFloats, 1.44269504F)));
  // ln 2 in two parts, Cody and Waite: the first product is exact.
  Floats r = hn::NegMulAdd(n, hn::Set(kFloats, 0.693359375F), depth);
  r = hn::NegMulAdd(n, hn::Set(kFloats, -2.12194440e-4F), r);
  // 1 − e^−r, |r| ≤ ln 2 / 2, by its series: the next term is 2e-8 of the first.
  Floats series = hn::Set(kFloats, 1.0F / 5040);
  series = hn::MulAdd(series, r, hn::Set(kFloats, -1.0F / 720));
  series = hn::MulAdd(series, r, hn::Set(kFloats, 1.0F / 120));
  series = hn::MulAdd(series, r, hn::Set(kFloats, -1.0F / 24));
  series = hn::MulAdd(series, r, hn::Set(kFloats, 1.0F / 6));
  series = hn::MulAdd(series, r, hn::Set(kFloats, -0.5F));
  series = hn::Mul(hn::MulAdd(series, r, hn::Set(kFloats, 1.0F)), r);
  const Ints exponent = hn::Sub(hn::Set(kInts, 127), hn::ConvertTo(kInts, n));
  const Floats scale = hn::BitCast(kFloats, hn::ShiftLeft<23>(exponent));
  return hn::MulAdd(scale, series, hn::Sub(hn::Set(kFloats, 1.0F), scale));
}

/// base^exponent for 0 ≤ base, one exponent for all lanes. Whole exponents take log₂ steps.
HWY_INLINE Floats power(Floats base, float exponent) {
  const Floats one = hn::Set(kFloats, 1.0F);
  if (exponent >= 0 && exponent <= 1024 && exponent == float(int(exponent))) {
    Floats result = one;
    Floats square = base;
    for (int rest = int(exponent); rest != 0; rest >>= 1) {
      if ((rest & 1) != 0) result = hn::Mul(result, square);
      square = hn::Mul(square, square);
    }
    return result;
  }
  const Floats logarithm = hn::Log(kFloats, hn::Max(base, hn::Set(kFloats, 1e-30F)));
  const Floats product = hn::Mul(logarithm, hn::Set(kFloats, exponent));
  const auto seen = hn::Gt(product, hn::Set(kFloats, -80.0F));
  return hn::IfThenElseZero(seen, hn::Exp(kFloats, hn::Min(product, hn::Set(kFloats, 80.0F))));
}

/// 1 / √x for normal x > 0, to 2 ulp: an estimate, then Newton's step where the estimate has at
/// least 14 bits; elsewhere by division.
HWY_INLINE Floats inverse_sqrt(Floats x) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  const Floats y = Floats{_mm512_rsqrt14_ps(x.raw)};
  const Floats half = hn::Mul(hn::Set(kFloats, 0.5F), x);
  const Floats rest = hn::NegMulAdd(hn::Mul(half, y), y, hn::Set(kFloats, 0.5F));
  return hn::MulAdd(y, rest, y);
#else
  return hn::Div(hn::Set(kFloats, 1.0F), hn::Sqrt(x));
#endif
}

/// False for NaN and both infinities.
HWY_INLINE FloatMask is_finite(Floats v) {
  return hn::Lt(hn::Abs(v), hn::Set(kFloats, std::numeric_limits<float>::infinity()));
}

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
