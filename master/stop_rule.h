// SPDX-License-Identifier: Apache-2.0
#pragma once
// When a picture is good enough. Asked after each step, of numbers that depend on the scene alone:
// so the set of samples that a finished picture holds does, too. Pure.

#include <cstdint>

#include "common/protocol/messages.h"
#include "common/tile/refinement.h"

namespace goldthread {

struct StopRule {
  Sampling sampling = Sampling::kAdaptive;
  double error = 0.5;         ///< RMS in 1/255
  std::uint32_t samples = 0;  ///< per pixel; 0: no limit but for every-pixel, which takes one
};

/// How the workers are to refine under that rule.
Refinement refinement_of(const StopRule& rule);

/// The RMS error in 1/255 that a sum of squares over `pixels` pixels means.
double rms_error(double squared_error, double pixels);

/// Whether a picture of `pixels` pixels needs no step after this one: its error is small enough, or
/// its samples as many as are wanted.
bool is_enough(const StopRule& rule, Step step, const TileQuality& quality, std::uint64_t rays,
               double pixels);

}  // namespace goldthread
