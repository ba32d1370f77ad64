// SPDX-License-Identifier: Apache-2.0
#pragma once
// Adaptive refinement's part of the report as JSON.

#include <nlohmann/json.hpp>

#include "bench/error/report.h"

namespace goldthread::bench {

nlohmann::ordered_json json_of(const Seconds& seconds);
nlohmann::ordered_json json_of(const AdaptiveReport& report);
nlohmann::ordered_json json_of(const InterruptRow& row);

}  // namespace goldthread::bench
