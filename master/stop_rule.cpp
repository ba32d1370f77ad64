// SPDX-License-Identifier: Apache-2.0
#include "master/stop_rule.h"

#include <algorithm>
#include <cmath>

namespace goldthread {

Refinement refinement_of(const StopRule& rule) {
  Refinement refinement;
  refinement.sampling = rule.sampling;
  if (rule.samples > 0) refinement.most_samples = rule.samples;
  return refinement;
}

double rms_error(double squared_error, double pixels) {
  return 255 * std::sqrt(squared_error / pixels);
}

bool is_enough(const StopRule& rule, Step step, const TileQuality& quality, std::uint64_t rays,
               double pixels) {
  if (step >= kLastStep) return true;
  // The coarse steps tell too little to stop at.
  if (step < kFirstAdaptiveStep) return false;
  // Not by its rays: small pictures have more of them around their pixels than in them.
  if (rule.sampling == Sampling::kEveryPixel)
    return even_samples(step) >= std::max(rule.samples, 1U);
  if (rule.samples > 0 && double(rays) >= double(rule.samples) * pixels) return true;
  return rms_error(quality.squared_error, pixels) <= rule.error;
}

}  // namespace goldthread
