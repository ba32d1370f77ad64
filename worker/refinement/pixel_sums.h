// SPDX-License-Identifier: Apache-2.0
#pragma once
// Pixels that hold more than one sample: sums in the order of the samples, in double precision. The
// mean of 2^20 samples in 0 … 1 is off by at most 2^20 · 2^-53 = 1.2e-10 of itself, and the same to
// the bit whatever steps the samples came in. Variance is kept by Welford's recurrence, of what is
// displayed.

#include <array>
#include <cstdint>
#include <vector>

#include "worker/refinement/tile_lattice.h"

namespace goldthread {

/// How samples of a pixel tell the error of their mean, from the squared share of its bend that a
/// centre sample is off by (as learned from many pixels): where it is large, bends are edges.
struct PixelErrorModel {
  explicit PixelErrorModel(double squared_share);
  double gain;   ///< of variance / count^3/2
  double unmet;  ///< of bend² / (count + 1): what all samples may have missed
};

class PixelSum {
 public:
  /// `bend`: the second difference of the pixel's centre and its neighbours'.
  PixelSum(SampleOffset place, double bend, const Sample& first, const Shown& first_shown);

  SampleOffset place() const { return place_; }
  std::uint32_t count() const { return count_; }
  void add(const Sample& sample, const Shown& shown);
  Sample mean() const;
  /// Of the samples, about their mean; mean over the channels.
  double variance() const { return count_ > 1 ? squares_ / (3.0 * (count_ - 1)) : 0; }
  /// Estimated squared error of the mean. Scrambled Sobol samples of an edge converge like
  /// count^-3/2 in variance; the factor is measured. Samples that all agree may still have missed
  /// what made the centre bend, so that where bends were edges such a pixel counts as not yet
  /// known.
  double squared_error(const PixelErrorModel& model) const;
  double bend() const { return bend_; }
  /// The first sample, as displayed.
  const Shown& centre() const { return centre_; }
  /// The mean of the displayed samples after the first.
  Shown mean_of_others() const;

 private:
  SampleOffset place_;
  double bend_;
  std::uint32_t count_ = 0;
  Shown centre_;
  std::array<double, 4> sums_{};
  std::array<double, 3> means_{};  ///< of the displayed samples
  double squares_ = 0;
};

}  // namespace goldthread
