// SPDX-License-Identifier: Apache-2.0
#include "worker/refinement/step_plan.h"

#include <algorithm>
#include <cmath>

namespace goldthread {
namespace {

constexpr double kFirstThreshold = 136.0 / 255;
/// Relative to the threshold.
constexpr double kBend = 0.5;
constexpr double kEdge = 2;
constexpr double kWorth = 0.2;

/// One for three steps, two for three, then twice as many every two steps, to all.
int probes_at(int round) {
  if (round < 6) return 1 + round / 3;
  return 1 << std::min(8, round / 2 - 1);
}

}  // namespace

StepPlan plan_of(Step step) {
  const int round = std::max(0, int(step.value) - int(kFirstAdaptiveStep.value));
  const double threshold = kFirstThreshold * std::pow(2.0, -0.5 * round);
  StepPlan plan;
  plan.threshold = static_cast<float>(threshold);
  plan.bend = static_cast<float>(kBend * threshold);
  plan.edge = static_cast<float>(kEdge * threshold);
  plan.worth = kWorth * kWorth * threshold * threshold;
  plan.probes = probes_at(round);
  plan.even_samples = even_samples(step);
  return plan;
}

}  // namespace goldthread
