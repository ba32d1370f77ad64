// SPDX-License-Identifier: Apache-2.0
#include "master/stop_rule.h"

#include <algorithm>
#include <cmath>

namespace goldthread {

Refinement refinement_of(const StopRule& rule) {
  Refinement refinement;
  // Measured: where it is 34 times the error, few pictures are better than wanted at once.
  const double threshold = 34 * std::pow(rule.error / 0.5, 1.0 / 3) * rule.error / 255;
  refinement.first_threshold =
      std::min(refinement.first_threshold, static_cast<float>(threshold));
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
  const double samples = std::max<double>(rule.samples, 1);
  if (rule.sampling == Sampling::kEveryPixel) return double(rays) >= samples * pixels;
  if (rule.samples > 0 && double(rays) >= samples * pixels) return true;
  // The coarse steps tell too little to stop at.
  return step >= kFirstAdaptiveStep && rms_error(quality.squared_error, pixels) <= rule.error;
}

}  // namespace goldthread
