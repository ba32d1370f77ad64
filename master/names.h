// SPDX-License-Identifier: Apache-2.0
#pragma once
// The words for roles that users and scripts see.

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

}  // namespace goldthread
