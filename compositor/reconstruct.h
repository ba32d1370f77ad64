// SPDX-License-Identifier: Apache-2.0
#pragma once
// From samples to pixels: what no ray was cast for is filled from the coarser samples around, all
// of it put over the background, and filtered to another size where one is asked for. Pure. A pixel
// with a ray of its own gets exactly that, so that a picture of every pixel holds the rays' results
// and nothing else.

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "common/scene/scene.h"
#include "compositor/sample_array.h"

namespace goldthread {

/// Float RGBA, premultiplied, over the background: 4 floats a pixel, rows of the band from the top.
/// Tiles without any sample show the background.
std::vector<float> reconstruct(const SampleArray& samples, Filter filter,
                               const glm::dvec3& background);

/// The same as it is displayed: RGB8, 3 bytes a pixel, equal to display_rgb8() of the above, in
/// memory that is reused.
void reconstruct_shown(const SampleArray& samples, Filter filter, const glm::dvec3& background,
                       ColorSpace color_space, std::vector<std::uint8_t>& rgb);

/// Puts samples, `stride` in a row, over the background into the pixels of `rect` of a band's
/// picture.
void write_over(std::span<const Sample> samples, int stride, const PixelRect& rect,
                const glm::dvec3& background, const PixelRect& band, std::span<float> pixels);
/// The same as it is displayed.
void write_shown(std::span<const Sample> samples, int stride, const PixelRect& rect,
                 const glm::dvec3& background, const PixelRect& band, ColorSpace color_space,
                 std::span<std::uint8_t> rgb);

}  // namespace goldthread
