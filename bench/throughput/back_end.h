// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a compositor computes, part by part, on one core: from the samples of a frame to bytes for a
// page.

#include <functional>
#include <string>
#include <vector>

#include "bench/error/statistics.h"
#include "bench/error/subject.h"

namespace goldthread::bench {

/// One frame's samples, and what it takes to show them.
struct BackEndRow {
  std::string samples;  ///< "each pixel", "adaptive", "a moving frame"
  double known = 1;     ///< share of the pixels with a ray of their own
  Seconds shown;        ///< holes filled, put over the background, in 8 bits
  Seconds jpeg;         ///< that encoded
  Seconds zstd;
  Seconds all_jpeg;  ///< from samples to bytes
  Seconds all_zstd;
};

/// The subject's scene in frames of `size`, cast with the ray caster. `repeats` frames are shown of
/// each.
std::vector<BackEndRow> measure_back_end(const Subject& subject, ImageSize size, int repeats);

}  // namespace goldthread::bench
