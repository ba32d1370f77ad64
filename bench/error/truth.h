// SPDX-License-Identifier: Apache-2.0
#pragma once
// What refinement converges to: pixels filtered by a box, from many rays of the kernels in each. A
// pixel gets a regular grid of 4×4 rays, 16×16 where these differ at all, 48×48 where they differ
// much: at edges, a grid's error falls with its number of rays only to the power 3/4.

#include <functional>
#include <vector>

#include "bench/error/frame.h"
#include "bench/error/statistics.h"

namespace goldthread::bench {

struct TruthRequest {
  const SampleSource& source;
  const ImageSettings& image;
  Subset subset;
  Shift shift = {};  ///< of the pixels, for peers that have them elsewhere
  int threads = 1;
  std::function<void(double)> progress = [](double) {};
};

struct Truth {
  std::vector<Color> colors;  ///< of the subset's pixels
  double rays_per_pixel = 0;
  double coarser =
      0;  ///< RMS in 1/255 of the same with grids half as fine: several times its error
};
Truth filtered_truth(const TruthRequest& request);

}  // namespace goldthread::bench
