// SPDX-License-Identifier: Apache-2.0
#include "master/main/scene_setup.h"

#include <spdlog/spdlog.h>

#include "common/scene/scene_file.h"
#include "worker/kernels/scene_terms.h"

namespace goldthread {

Scene scene_of(const Options& options) {
  Scene scene = value_or_throw(read_scene(options.input));
  if (options.size) scene.image.size = *options.size;
  if (options.step_mm) scene.step_mm = *options.step_mm;
  return scene;
}

TileChoice tile_choice_of(const Options& options) {
  return {options.tile_px, options.schedule == Schedule::kRows};
}

StopRule stop_rule_of(const Options& options) {
  return {options.sampling, options.error, static_cast<std::uint32_t>(options.samples.value_or(0))};
}

double step_of(const Scene& scene, const VolumeInfo& info, const StopRule& rule) {
  if (scene.step_mm > 0 || rule.sampling == Sampling::kEveryPixel) return scene.step_mm;
  const Features features = features_of(scene.volumes.front(), scene.lights);
  return step_for_error(rule.error, info.geometry, features);
}

void log_volume(const VolumeInfo& info) {
  const glm::ivec3 size = info.geometry.size;
  spdlog::info("{}: {}×{}×{} {}, values {:g} … {:g}", info.file, size.x, size.y, size.z,
               name_of(info.type), info.minimum, info.maximum);
  for (const std::string& note : info.notes) spdlog::warn("{}: {}", info.file, note);
}

void log_lost_worker(Rank rank) {
  spdlog::warn("rank {}, a worker, has gone silent; the others go on with its tiles", rank.value);
}

}  // namespace goldthread
