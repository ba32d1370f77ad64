// SPDX-License-Identifier: Apache-2.0
#pragma once
// Joins the session's rules to its sockets. All of it runs on the gateway's thread, but for
// take_events. After whatever happened, settle() lets every idle socket pull its next frame and
// only then asks how the audience changed.

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "compositor/gateway/event_queue.h"
#include "compositor/gateway/gateway.h"
#include "compositor/gateway/session.h"

namespace goldthread {

class Hub {
 public:
  Hub(GatewayLimits limits, std::function<void()> on_event)
      : limits_(limits), on_event_(std::move(on_event)) {}

  const GatewayLimits& limits() const { return limits_; }
  Session& session() { return session_; }

  /// A page connected; `pull` writes its next frame unless it is still writing one.
  Viewer join(std::function<void()> pull);
  void leave(Viewer viewer);
  /// Calls `done` once no page is left: now, or when the last one leaves.
  void when_empty(std::function<void()> done);

  void settle();
  /// From any thread.
  std::vector<GatewayEvent> take_events();

  /// Counts an open socket until the returned guard goes; null if there are too many.
  std::shared_ptr<void> admit();

 private:
  GatewayLimits limits_;
  std::function<void()> on_event_;
  Session session_;
  std::map<Viewer, std::function<void()>> pulls_;
  std::function<void()> when_empty_;
  std::size_t sockets_ = 0;
  std::mutex mutex_;
  EventQueue events_;  ///< guarded by mutex_
};

}  // namespace goldthread
