// SPDX-License-Identifier: Apache-2.0
#pragma once
// The words for roles and ranks that users and scripts see.

#include <string>

#include "common/protocol/messages.h"

namespace goldthread {

constexpr const char* role_name(Role role) {
  switch (role) {
    case Role::kMaster:
      return "master";
    case Role::kCompositor:
      return "compositor";
    case Role::kWorker:
      return "worker";
  }
  return "";
}

inline std::string rank_name(Rank rank, const std::string& host) {
  return "rank " + std::to_string(rank.value) + (host.empty() ? "" : " on " + host);
}

}  // namespace goldthread
