// SPDX-License-Identifier: Apache-2.0
// Phong's formula, two-sided, at one position per lane.

#if defined(GOLDTHREAD_WORKER_KERNELS_SHADING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_SHADING_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_SHADING_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_SHADING_INL_H_
#endif

#include "worker/kernels/kernel_types.h"
#include "worker/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

/// v / |v|; zero where v vanishes or is not finite.
HWY_INLINE Floats3 normalised(const Floats3& v) {
  const Floats squared = dot(v, v);
  const auto usable = hn::And(hn::Gt(squared, hn::Set(kFloats, 1e-30F)), is_finite(squared));
  const Floats inverse = hn::IfThenElseZero(
      usable, inverse_sqrt(hn::IfThenElse(usable, squared, hn::Set(kFloats, 1.0F))));
  const auto along = [&](Floats component) HWY_ATTR {
    return hn::IfThenElseZero(usable, hn::Mul(component, inverse));
  };
  return {along(v.x), along(v.y), along(v.z)};
}

class PhongShading {
 public:
  /// `step` is the rays' direction in voxels, of any length.
  HWY_INLINE PhongShading(const PhongTerm& phong, const std::vector<LightTerm>& lights,
                          const Floats3& step)
      : phong_(phong), lights_(lights), ray_(normalised(transform(phong.world_from_index, step))) {}

  /// `color` lit. `gradient` is per voxel and a covector: it goes to the world by the inverse
  /// transpose. Where it vanishes the ambient term alone remains.
  HWY_INLINE Floats3 shade(const Floats3& color, const Floats3& gradient,
                           const Floats3& position) const {
    const Floats3 normal = normalised(transform(phong_.normal_from_gradient, gradient));
    const Floats normal_ray = dot(normal, ray_);
    const FloatMask lit = hn::Gt(dot(normal, normal), hn::Zero(kFloats));
    const Floats ambient = hn::Set(kFloats, phong_.ambient);
    Floats3 scale{ambient, ambient, ambient};
    Floats3 shine{hn::Zero(kFloats), hn::Zero(kFloats), hn::Zero(kFloats)};
    for (const LightTerm& light : lights_) {
      Floats3 to_light{hn::Set(kFloats, light.vector[0]), hn::Set(kFloats, light.vector[1]),
                       hn::Set(kFloats, light.vector[2])};
      if (light.is_point) {
        const Floats3 place = transform(phong_.world_from_index, position);
        to_light = normalised({hn::Sub(to_light.x, place.x), hn::Sub(to_light.y, place.y),
                               hn::Sub(to_light.z, place.z)});
      }
      const Floats normal_light = dot(normal, to_light);
      // r·v with r = 2(n·l)n − l and v against the ray; |r·v| does not see the sign of either.
      const Floats mirrored =
          hn::Sub(hn::Mul(hn::Add(normal_light, normal_light), normal_ray), dot(to_light, ray_));
      const Floats highlight =
          power(hn::Min(hn::Abs(mirrored), hn::Set(kFloats, 1.0F)), phong_.shininess);
      add_scaled(light.diffuse, hn::Abs(normal_light), scale);
      add_scaled(light.specular, hn::IfThenElseZero(lit, highlight), shine);
    }
    return {hn::MulAdd(color.x, scale.x, shine.x), hn::MulAdd(color.y, scale.y, shine.y),
            hn::MulAdd(color.z, scale.z, shine.z)};
  }

 private:
  static HWY_INLINE void add_scaled(const float* rgb, Floats factor, Floats3& to) {
    to.x = hn::MulAdd(factor, hn::Set(kFloats, rgb[0]), to.x);
    to.y = hn::MulAdd(factor, hn::Set(kFloats, rgb[1]), to.y);
    to.z = hn::MulAdd(factor, hn::Set(kFloats, rgb[2]), to.z);
  }

  const PhongTerm& phong_;
  const std::vector<LightTerm>& lights_;
  Floats3 ray_;  ///< the rays' directions in the world, of unit length
};

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
