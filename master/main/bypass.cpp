// SPDX-License-Identifier: Apache-2.0
#include "master/main/bypass.h"

#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "master/names.h"
#include "worker/bypass.h"

namespace goldthread {

Strategy strategy_of(const Bypass& bypass) {
  if (bypass.master) return {Order::kScreen, Share::kInterleaved, kSpareUs};
  return {.spare_us = kSpareUs};
}

CanvasMaker canvas_of(const Bypass& bypass) {
  return bypass.compositor ? make_bypassed_canvas : make_sample_canvas;
}

SourceMaker source_of(const Bypass& bypass) {
  return bypass.worker ? SourceMaker(no_source) : SourceMaker(make_ray_caster);
}

TileCaster caster_of(const Bypass& bypass) {
  return bypass.worker ? bypassed_tiles() : TileCaster(refine_tile);
}

std::vector<std::string> names_of(const Bypass& bypass) {
  std::vector<std::string> names;
  if (bypass.master) names.emplace_back(role_name(Role::kMaster));
  if (bypass.worker) names.emplace_back(role_name(Role::kWorker));
  if (bypass.compositor) names.emplace_back(role_name(Role::kCompositor));
  return names;
}

void warn_of_bypass(const Bypass& bypass) {
  if (bypass == Bypass{}) return;
  spdlog::warn("by-passed: {}; pictures show nothing that was computed",
               fmt::join(names_of(bypass), ", "));
}

}  // namespace goldthread
