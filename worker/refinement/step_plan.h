// SPDX-License-Identifier: Apache-2.0
#pragma once
// What each step of the golden thread does. All numbers in one place; how they were found is in
// docs/refinement.md.
//
//   step 1     one ray in 16×16 pixels
//   step 2     one ray in 8×8 pixels
//   step 3 …   down to the pixel where neighbours differ by more than a threshold, below the pixel
//              where edges need it, and some probes. The threshold falls from step to step: by 2
//              while it is large, then by √2. From there on most pixels of a square of 4×4 would be
//              wanted sooner or later, and all of them together are one packet of rays.

#include <cstdint>

#include "common/tile/refinement.h"

namespace goldthread {

/// Differences are of displayed colours, in 0 … 1.
struct StepPlan {
  float threshold = 0;  ///< neighbours that differ by more get a sample between them
  float bend = 0;       ///< SubdivisionRule::bend
  float edge = 0;       ///< a pixel whose second difference is larger gets samples of its own
  double worth = 0;     ///< squared error that a ray must take away
  int whole = 0;        ///< SubdivisionRule::whole
  int probes = 1;       ///< in each block of 16×16 pixels
  std::uint32_t even_samples = 1;  ///< in each pixel, for Sampling::kEveryPixel
};

StepPlan plan_of(Step step);

}  // namespace goldthread
