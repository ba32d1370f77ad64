// SPDX-License-Identifier: Apache-2.0
#pragma once
// The reference pictures of a subject, computed when they are first asked for, and how well they
// have converged.

#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "bench/error/bench_error.h"
#include "bench/error/frame.h"

namespace goldthread::bench {

class References {
 public:
  References(const Subject& subject, const ErrorBenchSettings& settings);

  /// On every settings.stride-th pixel.
  const std::vector<Color>& of(Look look);
  /// The same for sample points moved from the pixels' centres.
  const std::vector<Color>& moved(Look look, Shift shift);
  /// A peer's error at its best alignment, which is searched for on fewer pixels. `shown` is the
  /// whole subset.
  Alignment align(Look look, std::span<const Color> shown);

  /// What has been computed, and its convergence, without what was measured against it.
  const std::vector<ReferenceRow>& rows() const { return rows_; }

 private:
  /// A look, a stride, and a shift's x and y.
  using Key = std::tuple<Look, int, double, double>;

  std::vector<Color> compute(Look look, int stride, int substeps, Shift shift) const;
  /// Computed once.
  const std::vector<Color>& kept(Look look, int stride, int substeps, Shift shift);

  const Subject& subject_;
  const ErrorBenchSettings& settings_;
  std::vector<double> voxels_;
  std::map<Key, std::vector<Color>> pictures_;
  std::vector<ReferenceRow> rows_;
};

/// Every `keep`-th pixel in both directions of a subset's picture.
std::vector<Color> thinned(std::span<const Color> picture, const Subset& subset, int keep);

}  // namespace goldthread::bench
