// SPDX-License-Identifier: Apache-2.0
#pragma once
// The numbers that a measurement is boiled down to: times to a median, two pictures to an error.
// Pure. Errors are in units of 1/255 of a displayed channel, as users see them.

#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "common/tile/sample.h"

namespace goldthread::bench {

/// Displayed red, green and blue in 0 … 1, before they become 8 bits.
using Color = glm::dvec3;

/// The middle one, or the mean of the two middle ones; NaN of nothing.
double median(std::vector<double> values);
/// The least one that a share of them does not exceed (nearest rank); NaN of nothing.
double percentile(std::vector<double> values, double share);

/// Wall-clock times of repeated frames.
struct Seconds {
  double minimum = 0;
  double median = 0;
  int count = 0;
};
Seconds summarize(std::span<const double> seconds);

/// How far a shown picture is from the reference.
struct PictureError {
  double rms = 0;             ///< over all channels of all pixels
  double percentile_999 = 0;  ///< of the pixels' largest channel differences, nearest rank
  double maximum = 0;
  double share_off_by_32 = 0;  ///< pixels with a channel off by more than 32/255
};
/// Both pictures hold the same pixels. A value that is not a number counts as off by 255.
PictureError picture_error(std::span<const Color> shown, std::span<const Color> reference);

/// What is shown of a ray: over the background, within 0 … 1; encoded to sRGB if `linear`.
Color displayed(const glm::dvec3& premultiplied, double alpha, const glm::dvec3& background,
                bool linear);
Color displayed(const Sample& sample, const glm::dvec3& background, bool linear);

/// Where a renderer may have its pixels' sample points, relative to the pixels' centres, in pixels.
struct Shift {
  double x = 0;
  double y = 0;
  bool operator==(const Shift&) const = default;
};
/// From −1 to 1 pixel in both directions, in steps of half a pixel, the nearest to 0 first.
std::vector<Shift> candidate_shifts();

/// The candidate whose reference is nearest to the shown picture by RMS; the first of equals.
struct Alignment {
  Shift shift;
  PictureError error;
};
Alignment best_alignment(std::span<const Color> shown,
                         const std::function<std::vector<Color>(Shift)>& reference_at);

/// The order of convergence that two errors show: log(e₁/e₂) / log(h₁/h₂).
double order_between(double coarse_step, double coarse_error, double fine_step, double fine_error);

}  // namespace goldthread::bench
