// SPDX-License-Identifier: Apache-2.0
#pragma once
// The report's plots as gnuplot scripts, data included. Pure: who runs them finds NAME.svg and
// NAME.png in the working directory.

#include <string>
#include <vector>

#include "bench/error/report.h"

namespace goldthread::bench {

struct Plot {
  std::string name;    ///< "error-time"
  std::string script;  ///< empty if there is nothing to show
};

/// Error against time, error against step (both log-log), and samples per second; of adaptive
/// refinement error against time and against rays.
std::vector<Plot> plots_of(const Report& report);

/// Scripts of the latter two.
std::string adaptive_time(const Report& report);
std::string adaptive_rays(const Report& report);

}  // namespace goldthread::bench
