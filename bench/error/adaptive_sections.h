// SPDX-License-Identifier: Apache-2.0
#pragma once
// Adaptive refinement's part of the report for people. Pure.

#include <vector>

#include "bench/error/report.h"

namespace goldthread::bench {

/// None of what was not measured.
void add_adaptive_sections(const Report& report, std::vector<Section>& sections);

}  // namespace goldthread::bench
