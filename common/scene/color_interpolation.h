// SPDX-License-Identifier: Apache-2.0
#pragma once
// Colours between two colours in the spaces that ParaView's colour maps are made in. All colours
// are displayed (sRGB) values in 0…1.

#include <cstdint>
#include <glm/glm.hpp>

namespace goldthread {

enum class MapSpace : std::uint8_t {
  kRgb,
  kHsv,         ///< hue goes the way of its numbers
  kHsvWrapped,  ///< hue goes the short way round
  kLab,         ///< CIE L*a*b*, D65
  kDiverging,   ///< Moreland, "Diverging Color Maps for Scientific Visualization", 2009
  kStep         ///< the second colour from just after the first on, as VTK has it
};

/// The colour at `share` (0…1) of the way from `first` to `second`, in 0…1 each.
glm::dvec3 mix_colors(MapSpace space, const glm::dvec3& first, const glm::dvec3& second,
                      double share);

}  // namespace goldthread
