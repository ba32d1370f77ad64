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
  const Floats one = hn::Set(kFloats, 1.0F);
  const Floats inverse = hn::Div(one, hn::Sqrt(hn::IfThenElse(usable, squared, one)));
  return {hn::IfThenElseZero(usable, hn::Mul(v.x, inverse)),
          hn::IfThenElseZero(usable, hn::Mul(v.y, inverse)),
          hn::IfThenElseZero(usable, hn::Mul(v.z, inverse))};
}

/// `color` lit. `gradient` is per voxel and a covector: it goes to the world by the inverse
/// transpose. `step` is the ray's direction in voxels, of any length. Where the gradient vanishes
/// the ambient term alone remains.
HWY_INLINE Floats3 shade(const PhongTerm& phong, const std::vector<LightTerm>& lights,
                         const Floats3& color, const Floats3& gradient, const Floats3& position,
                         const Floats3& step) {
  const Floats3 normal = normalised(transform(phong.normal_from_gradient, gradient));
  const Floats3 ray = normalised(transform(phong.world_from_index, step));
  const Floats normal_ray = dot(normal, ray);
  const FloatMask lit = hn::Gt(dot(normal, normal), hn::Zero(kFloats));
  const Floats ambient = hn::Set(kFloats, phong.ambient);
  Floats3 scale{ambient, ambient, ambient};
  Floats3 shine{hn::Zero(kFloats), hn::Zero(kFloats), hn::Zero(kFloats)};
  for (const LightTerm& light : lights) {
    Floats3 to_light{hn::Set(kFloats, light.vector[0]), hn::Set(kFloats, light.vector[1]),
                     hn::Set(kFloats, light.vector[2])};
    if (light.is_point) {
      const Floats3 place = transform(phong.world_from_index, position);
      to_light = normalised({hn::Sub(to_light.x, place.x), hn::Sub(to_light.y, place.y),
                             hn::Sub(to_light.z, place.z)});
    }
    const Floats normal_light = dot(normal, to_light);
    // r·v with r = 2(n·l)n − l and v against the ray; |r·v| does not see the sign of either.
    const Floats mirrored =
        hn::Sub(hn::Mul(hn::Add(normal_light, normal_light), normal_ray), dot(to_light, ray));
    const Floats highlight =
        power(hn::Min(hn::Abs(mirrored), hn::Set(kFloats, 1.0F)), phong.shininess);
    const Floats facing = hn::Abs(normal_light);
    const Floats glint = hn::IfThenElseZero(lit, highlight);
    scale.x = hn::MulAdd(facing, hn::Set(kFloats, light.diffuse[0]), scale.x);
    scale.y = hn::MulAdd(facing, hn::Set(kFloats, light.diffuse[1]), scale.y);
    scale.z = hn::MulAdd(facing, hn::Set(kFloats, light.diffuse[2]), scale.z);
    shine.x = hn::MulAdd(glint, hn::Set(kFloats, light.specular[0]), shine.x);
    shine.y = hn::MulAdd(glint, hn::Set(kFloats, light.specular[1]), shine.y);
    shine.z = hn::MulAdd(glint, hn::Set(kFloats, light.specular[2]), shine.z);
  }
  return {hn::MulAdd(color.x, scale.x, shine.x), hn::MulAdd(color.y, scale.y, shine.y),
          hn::MulAdd(color.z, scale.z, shine.z)};
}

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
