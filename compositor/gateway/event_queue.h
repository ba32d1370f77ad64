// SPDX-License-Identifier: Apache-2.0
#pragma once
// What pages asked for and nobody has taken yet, in order. Bounded whatever the pages send and
// however late the events are taken: states (camera, size, display, audience) replace each other,
// edits count against a limit.

#include <cstddef>
#include <vector>

#include "compositor/gateway/gateway.h"

namespace goldthread {

class EventQueue {
 public:
  static constexpr std::size_t kMaxEdits = 1024;
  static constexpr std::size_t kMaxEditBytes = std::size_t{16} << 20;

  /// False, and nothing is kept, if the edit would exceed the limits.
  bool push(GatewayEvent event);
  std::vector<GatewayEvent> take();

 private:
  std::vector<GatewayEvent> events_;
  std::size_t edits_ = 0;
  std::size_t edit_bytes_ = 0;
};

}  // namespace goldthread
