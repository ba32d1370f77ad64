// SPDX-License-Identifier: Apache-2.0
#include "bench/error/adaptive_method.h"

#include "bench/error/ray_log.h"
#include "bench/error/rounds.h"

namespace goldthread::bench {
namespace {

double pixels_of(ImageSize size) { return double(size.width) * size.height; }

}  // namespace

Aim Aim::at_error(double error) {
  const StopRule rule{Sampling::kAdaptive, error};
  return {rule, refinement_of(rule)};
}

AdaptiveMethod::AdaptiveMethod(Scene scene, std::shared_ptr<const Volume> volume, const Aim& aim)
    : scene_(std::move(scene)), committed_(commit_scene(scene_, std::move(volume))), aim_(aim) {}

std::shared_ptr<const SampleSource> AdaptiveMethod::source() const {
  return make_ray_caster(committed_, *scene_.camera, scene_.image.size);
}

Refined AdaptiveMethod::refine(AdaptiveCaster& caster, const SampleSource& source) const {
  return caster.cast(source, scene_.image, aim_.how, [&](const Refined& so_far) {
    return so_far.step >= aim_.last || is_enough(aim_.rule, so_far.step, so_far.quality,
                                                 so_far.rays, pixels_of(scene_.image.size));
  });
}

double AdaptiveMethod::frame_seconds(AdaptiveCaster& caster) {
  const double before = caster.crew().cpu_seconds();
  const double seconds = seconds_of([&] { refined_ = refine(caster, *source()); });
  cpu_seconds_.push_back(caster.crew().cpu_seconds() - before);
  return seconds;
}

double AdaptiveMethod::estimated_rms() const {
  return rms_error(refined_.quality.squared_error, pixels_of(scene_.image.size));
}

double AdaptiveMethod::cast_seconds(AdaptiveCaster& caster, int repeats) const {
  const auto plain = source();
  RayLog log(*plain);
  refine(caster, log);
  std::vector<double> seconds;
  seconds.reserve(std::size_t(repeats));
  for (int i = 0; i < repeats; ++i) seconds.push_back(log.replay(caster.crew()));
  return median(seconds);
}

}  // namespace goldthread::bench
