// SPDX-License-Identifier: Apache-2.0
#include "worker/refinement/step_plan.h"

#include <algorithm>
#include <cmath>

namespace goldthread {
namespace {

constexpr double kFirstThreshold = 136.0 / 255;
/// Down to here the threshold is halved by each step.
constexpr double kFineThreshold = 17.0 / 255;
bool is_fine(double threshold) { return threshold < 1.01 * kFineThreshold; }
/// The edge, in pixels, of what one packet of rays takes whole when the threshold is fine.
constexpr int kPacketEdge = 4;
/// Relative to the threshold.
constexpr double kBend = 0.5;
constexpr double kEdge = 2;
constexpr double kWorth = 0.2;

/// How many places of each block have been probed by the time the threshold has come down to this:
/// for each half octave below the first one to start with, and twice as many every octave where it
/// is small.
int probes_by(double threshold) {
  const int half_octaves =
      static_cast<int>(std::lround(2 * std::log2(kFirstThreshold / threshold)));
  int sum = 0;
  for (int i = 0; i <= half_octaves && sum < 256; ++i) sum += i < 6 ? 1 + i / 3 : 1 << (i / 2 - 1);
  return std::min(sum, 256);
}

double threshold_at(int round) {
  double threshold = kFirstThreshold;
  for (; round > 0 && !is_fine(threshold); --round) threshold /= 2;
  return threshold * std::pow(2.0, -0.5 * round);
}

}  // namespace

StepPlan plan_of(Step step) {
  const int round = std::max(0, int(step.value) - int(kFirstAdaptiveStep.value));
  const double threshold = threshold_at(round);
  StepPlan plan;
  plan.threshold = static_cast<float>(threshold);
  plan.bend = static_cast<float>(kBend * threshold);
  plan.edge = static_cast<float>(kEdge * threshold);
  plan.worth = kWorth * kWorth * threshold * threshold;
  plan.whole = is_fine(threshold) ? kPacketEdge : 0;
  plan.probes = probes_by(threshold);
  if (round > 0) plan.probes -= probes_by(threshold_at(round - 1));
  plan.even_samples = even_samples(step);
  return plan;
}

}  // namespace goldthread
