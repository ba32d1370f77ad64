// SPDX-License-Identifier: Apache-2.0
#include "worker/kernels/kernel_table.h"

#include "worker/kernels/kernel_units.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "worker/kernels/kernel_table.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {
std::int64_t this_target() { return HWY_TARGET; }
}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace goldthread {
namespace {

HWY_EXPORT(this_target);

using Unit = CastCounts (*)(Features, const CastArguments&);

// By storage, and whether the scene is shaded.
constexpr Unit kUnits[3][2] = {
    {cast_uint8, cast_uint8_lit}, {cast_uint16, cast_uint16_lit}, {cast_float32, cast_float32_lit}};

}  // namespace

Storage storage_of(VoxelType type) {
  switch (bytes_per_voxel(type)) {
    case 1:
      return Storage::kUInt8;
    case 2:
      return Storage::kUInt16;
    default:
      return Storage::kFloat32;
  }
}

Kernel find_kernel(Features features, Storage storage) {
  return {features, storage, kUnits[int(storage)][features.shading ? 1 : 0]};
}

std::vector<std::string> names_of(Features features) {
  std::vector<std::string> names;
  if (features.dvr) names.emplace_back("dvr");
  if (features.mip) names.emplace_back("mip");
  if (features.isosurfaces) names.emplace_back("isosurfaces");
  if (features.shading) names.emplace_back("shading");
  return names;
}

std::string instruction_set() { return hwy::TargetName(HWY_DYNAMIC_DISPATCH(this_target)()); }

std::vector<std::string> instruction_sets() {
  std::vector<std::string> names;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
    names.emplace_back(hwy::TargetName(target));
  return names;
}

void force_instruction_set(const std::string& name) {
  hwy::SetSupportedTargetsForTest(0);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
    if (name == hwy::TargetName(target)) hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace goldthread
#endif
