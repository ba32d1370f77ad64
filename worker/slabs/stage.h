// SPDX-License-Identifier: Apache-2.0
#pragma once
// A ray on its way through slabs: what is done with it, and what it brings along.

#include <limits>

#include "common/tile/sample.h"

namespace goldthread {

/// What is done with rays. Through a whole volume they go once, from nothing to finished samples.
/// Through slabs they go in the order of depth, and `samples` and `surfaces` hold what they have
/// gathered: sums of colour and opacity; of mip the greatest value so far (red) and where it was
/// found, in steps from the ray's first segment (green).
struct Stage {
  bool resumes = false;   ///< `samples` and `surfaces` hold what was gathered before
  bool marches = true;    ///< gather; mip goes on with this through all slabs before it …
  bool completes = true;  ///< … takes the exact value around the best, in the slab that has it
  bool closes = true;     ///< sums become samples
};

/// Before the first slab of mip: no value is known.
constexpr Sample kNoValue{-std::numeric_limits<float>::infinity(), 0, 0, 0};

/// Through slabs rays gather first; mip then takes the exact value around the best one.
constexpr Stage kGather{.resumes = true, .marches = true, .completes = false, .closes = false};
constexpr Stage kComplete{.resumes = true, .marches = false, .completes = true, .closes = true};

/// A ray ends where less than this share of what lies behind could still be seen. What it has met
/// then stands for the rest: its colour is divided by its opacity, so that a colour channel is off
/// by less than this times the difference of the two, and opacity by less than this, 0.25/255.
constexpr float kLeastTransmittance = 1.0F / 1024;

/// Whether a ray with these sums can still see what lies behind.
constexpr bool is_open(const Sample& sums) { return 1.0F - sums.alpha > kLeastTransmittance; }

/// Sums of colour and opacity as the sample they are: what kernels do with closes, to the bit.
inline Sample closed(const Sample& sums) {
  if (is_open(sums)) return sums;
  const float share = 1.0F / sums.alpha;
  return {sums.red * share, sums.green * share, sums.blue * share, 1.0F};
}

}  // namespace goldthread
