// SPDX-License-Identifier: Apache-2.0
#pragma once
// Colours for the places of a tile that no ray was cast for, from the coarser samples around them:
// the worker measures new samples against them, the compositor shows them. Pure.

#include <cstdint>
#include <span>

#include "common/tile/refinement.h"
#include "common/tile/sample.h"

namespace goldthread {

/// One tile's places, row by row from the top: `stride` in a row, `rows` rows, both one more than a
/// multiple of the coarsest spacing, 16.
struct TilePlane {
  int stride = 0;
  int rows = 0;
  std::span<Sample> samples;            ///< stride × rows
  std::span<const std::uint8_t> known;  ///< stride × rows; not 0: a ray's result, never changed
};

/// Fills the places that are not known, spacing by spacing: for squares of 16, 8, 4 and 2 pixels,
/// first the middles of their edges, then their centres, as in the subdivision of Bergman et al.
/// 1986 ("Image rendering by adaptive refinement"), from what is known or filled by then. All
/// places at multiples of 16 must be known, or nothing at all: then nothing is done.
///
/// The middle between a and b, whose neighbours beyond are c and d, and the centre of a square:
/// - box: a, the left or upper one; the centre is the middle of the left edge. Constant blocks.
/// - bilinear: (a+b)/2; the centre is the mean of the edges' four middles. Convex: never beyond the
///   known samples. The kernels of the biquadratic and of the piecewise quadratic filter halfway
///   between two samples say the same; they differ where a picture is resampled.
/// - bicubic: (9a+9b−c−d)/16, the cubic through all four; (3b+6a−c)/8 where the tile ends beyond b,
///   and likewise beyond a; (a+b)/2 where both. The centre is the mean of this rule along the row
///   and along the column. Colours are kept from falling below 0, and opacity within 0 … 1.
void fill_holes(const TilePlane& plane, Filter filter);

}  // namespace goldthread
