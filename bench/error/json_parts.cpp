// SPDX-License-Identifier: Apache-2.0
#include "bench/error/json_parts.h"

namespace goldthread::bench {

using Json = nlohmann::ordered_json;

Json json_of(const Machine& machine) {
  return {{"processor", machine.processor}, {"cores", machine.cores}, {"system", machine.system}};
}

Json json_of(const Goal& goal) {
  return {{"what", goal.what},
          {"goal", goal.goal},
          {"reached", goal.reached},
          {"met", goal.met ? Json(*goal.met) : Json()}};
}

}  // namespace goldthread::bench
