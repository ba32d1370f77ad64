// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/event_queue.h"

#include <utility>

namespace goldthread {
namespace {

// A camera, a size or display settings replace older ones whichever page they are from: only the
// newest count, and pages that come and go cannot fill the queue.
bool overtakes(const GatewayEvent& newer, const GatewayEvent& older) {
  return newer.index() == older.index() && !std::holds_alternative<EditInput>(newer);
}

}  // namespace

bool EventQueue::push(GatewayEvent event) {
  if (const auto* edit = std::get_if<EditInput>(&event)) {
    const std::size_t bytes = edit->edit_json.size();
    if (edits_ >= kMaxEdits || bytes > kMaxEditBytes - edit_bytes_) return false;
    ++edits_;
    edit_bytes_ += bytes;
  } else {
    std::erase_if(events_, [&](const GatewayEvent& older) { return overtakes(event, older); });
  }
  events_.push_back(std::move(event));
  return true;
}

std::vector<GatewayEvent> EventQueue::take() {
  edits_ = 0;
  edit_bytes_ = 0;
  return std::exchange(events_, {});
}

}  // namespace goldthread
