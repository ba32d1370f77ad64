// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where in a picture the time of the compute threads went: an image of seconds per pixel, each
// tile's evenly over its own pixels, so that the sum over any tiles is the time spent on them.
// Pure.

#include <cstdint>
#include <string>
#include <vector>

#include "master/cluster.h"

namespace goldthread {

/// Seconds per pixel of the view's image, rows from the top.
std::vector<float> cost_per_pixel(const ViewState& view);

/// The same to look at: 8-bit RGB rows, viridis from nothing to the dearest, the upper and left
/// edges of tiles darkened.
std::vector<std::uint8_t> cost_rgb8(const ViewState& view);

/// What the brightest colour stands for: "0 to 1.25 ms per 64x64 pixels".
std::string cost_scale(const ViewState& view);

}  // namespace goldthread
