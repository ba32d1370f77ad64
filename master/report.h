// SPDX-License-Identifier: Apache-2.0
#pragma once
// The report of a render: what it took, in JSON, for scripts and benchmarks.

#include <optional>
#include <string>
#include <vector>

#include "master/cluster.h"

namespace goldthread {

/// The estimated RMS error of what the compositors hold of a view, in 1/255; 255 before the first
/// picture.
double estimated_error(const ViewState& view);

/// How far the costs of the view's tiles were from those predicted by the last one; nothing if that
/// was the first.
std::optional<double> prediction_error(const ViewState& view);

/// frames, features, kernel, ranks, tiles (of the last frame), messages and bytes by kind of
/// message (of the whole cluster), the names of the roles that were by-passed, loadSeconds,
/// version.
std::string report_json(const Cluster& cluster, const std::vector<ViewState>& frames,
                        double load_seconds, const std::vector<std::string>& bypassed);

}  // namespace goldthread
