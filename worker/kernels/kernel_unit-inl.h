// SPDX-License-Identifier: Apache-2.0
// One unit of kernels, compiled for every instruction set and exported under one name. A .cpp file
// names its unit and includes this file: units are apart so that each builds in well under a
// minute. The .cpp defines
//   KERNEL_UNIT     the exported function
//   KERNEL_STORAGE  a Storage
//   KERNEL_LIT      whether the unit holds the shaded kernels (true) or the others (false)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "worker/kernels/kernel_unit-inl.h"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include "worker/kernels/cast-inl.h"
#include "worker/kernels/kernel_units.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

/// The kernel for `features`, which are the same for all rays of the call.
static CastCounts cast_unit(Features features, const CastArguments& arguments) {
  constexpr Storage kStorage = Storage::KERNEL_STORAGE;
  constexpr bool kLit = KERNEL_LIT;
  constexpr Features kDvr{.dvr = true, .shading = kLit};
  constexpr Features kSurfaces{.shading = kLit, .isosurfaces = true};
  constexpr Features kBoth{.dvr = true, .shading = kLit, .isosurfaces = true};
  if constexpr (!kLit) {
    if (features.mip) return cast<kStorage, Features{.mip = true}>(arguments);
  }
  if (features == kDvr) return cast<kStorage, kDvr>(arguments);
  if (features == kSurfaces) return cast<kStorage, kSurfaces>(arguments);
  return cast<kStorage, kBoth>(arguments);
}

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace goldthread {
HWY_EXPORT(cast_unit);
// Each unit includes this once, under a name of its own.
// NOLINTNEXTLINE(misc-definitions-in-headers)
CastCounts KERNEL_UNIT(Features features, const CastArguments& arguments) {
  return HWY_DYNAMIC_DISPATCH(cast_unit)(features, arguments);
}
}  // namespace goldthread
#endif
