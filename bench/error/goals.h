// SPDX-License-Identifier: Apache-2.0
#pragma once
// How goals are worded. Pure.

#include <string>
#include <vector>

#include "bench/error/report.h"

namespace goldthread::bench {

/// A time over a peer's, by medians; null where it was not measured.
Goal speed_up(std::string what, const std::string& peer, const Seconds* theirs, const Seconds* ours,
              double wanted);
Goal at_most(std::string what, double wanted, std::optional<double> reached);

/// Those of adaptive refinement, and of interrupts.
void add_adaptive_goals(const Report& report, std::vector<Goal>& goals);

}  // namespace goldthread::bench
