// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which machine a measurement was taken on.

#include "bench/error/report.h"

namespace goldthread::bench {

Machine this_machine();
/// Now, in UTC: "2026-01-31T12:00:00Z".
std::string date_now();

}  // namespace goldthread::bench
