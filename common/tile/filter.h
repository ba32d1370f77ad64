// SPDX-License-Identifier: Apache-2.0
#pragma once
// Reconstruction filters, and pictures resampled with them: a page that changes its size or filter
// gets the samples that are there, no ray is cast again. Pure.

#include <span>
#include <vector>

#include "common/base/types.h"
#include "common/tile/refinement.h"

namespace goldthread {

/// The filter's kernel in one dimension, `t` in sample spacings. In two dimensions it is the
/// product of both. Even, and the weights of all samples sum to 1 anywhere.
/// - box: 1 for −½ ≤ t < ½. Interpolates, of first order.
/// - bilinear: 1 − |t|. Interpolates, of second order.
/// - biquadratic: the quadratic B-spline (Hou & Andrews 1978). Smooths, does not interpolate;
///   second order, C¹, never negative.
/// - piecewise quadratic: the interpolating one (r = 1) of Dodgson 1997, "Quadratic interpolation
///   for image resampling". Second order, C⁰: straight lines are kept, parabolas are not.
/// - bicubic: cubic convolution with a = −½ (Keys 1981), which is Catmull & Rom's spline.
///   Interpolates, of third order: parabolas are kept; C¹.
double weight(Filter filter, double t);

/// The kernel is 0 for |t| above this.
double support(Filter filter);

/// A rectangle of a picture, in its pixels from its top left corner; the centre of pixel (i, j) is
/// (i + 0.5, j + 0.5).
struct SourceWindow {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;
};

/// `rgba`, 4 floats a pixel and rows from the top, of `from` pixels, as a picture of `to` pixels
/// that shows the window. Sizes and the window's sides are positive. Where the window's pixels are
/// more than the picture's, the kernel is widened by as much, so that nothing aliases; the box is
/// then the exact mean over a pixel's area. Pixels beyond the edges are those at the edges. Filters
/// that overshoot are kept from falling below 0, and opacity within 0 … 1.
///
/// The whole picture at its own size is the same to the bit, but for biquadratic, which smooths.
std::vector<float> resample(std::span<const float> rgba, ImageSize from, const SourceWindow& window,
                            ImageSize to, Filter filter);

}  // namespace goldthread
