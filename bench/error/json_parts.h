// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the reports of all benches have in common, as JSON.

#include <nlohmann/json.hpp>

#include "bench/error/report.h"

namespace goldthread::bench {

nlohmann::ordered_json json_of(const Machine& machine);
nlohmann::ordered_json json_of(const Goal& goal);

}  // namespace goldthread::bench
