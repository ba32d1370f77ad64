// SPDX-License-Identifier: Apache-2.0
#pragma once
// How threads that compute share the cores with those that move messages.

#include <sched.h>

namespace goldthread {

/// Under SCHED_IDLE a computing thread leaves the core the moment a rank that moves messages wants
/// it; needs no privilege. If it is refused, the thread computes as any other would.
inline void give_way() {
  const sched_param parameters{};
  sched_setscheduler(0, SCHED_IDLE, &parameters);
}

}  // namespace goldthread
