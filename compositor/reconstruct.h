// SPDX-License-Identifier: Apache-2.0
#pragma once
// From samples to pixels: bilinear between the samples of each tile's own level, over the
// background. Pure. A pixel on a sample gets exactly that sample, so that a picture at the pixel
// level holds the rays' results and nothing else.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "common/scene/scene.h"
#include "compositor/sample_array.h"

namespace goldthread {

/// Float RGBA, premultiplied, over the background: 4 floats a pixel, rows of the band from the top.
/// Tiles without any sample show the background.
std::vector<float> reconstruct(const SampleArray& samples, const glm::dvec3& background);

/// Estimated mean square error of the picture's colours at its level, per channel: for each sample
/// between two others of its row or column, a quarter of its squared distance from their mean. Half
/// that distance is what a step to the next finer level would still change where the picture is
/// smooth or has edges; not calibrated.
double estimate_squared_error(const SampleArray& samples);

}  // namespace goldthread
