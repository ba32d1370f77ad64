// SPDX-License-Identifier: Apache-2.0
#pragma once
// The transfer function as a table for kernels. Between rows all is linear, as it is between the
// function's nodes: only extinction's logarithm and nodes between two rows are approximated.

#include <vector>

#include "common/scene/scene.h"
#include "common/volume/volume.h"
#include "worker/kernels/kernel_types.h"

namespace goldthread {

/// Rows over the values that both the data and the nodes span; constant outside. Integer data gets
/// a whole number of rows per value, so that nodes at whole values are exact. Rows are 16 bytes.
class TransferRows {
 public:
  /// Colours of `function` are taken as they are, and multiplied by `color_factor`; opacities are
  /// those of a segment of `step_mm`.
  TransferRows(const TransferFunction& function, const VolumeInfo& info, double value_bias,
               double color_factor, double step_mm = 1);

  TransferTable view() const;
  /// The distance of two rows in data values.
  double row_distance() const { return 1.0 / rows_per_value_; }

 private:
  std::vector<float> rows_;
  std::vector<float> extinctions_;
  std::vector<float> opacities_;
  TransferSegments segments_;
  float first_value_ = 0;
  float rows_per_value_ = 0;
};

}  // namespace goldthread
