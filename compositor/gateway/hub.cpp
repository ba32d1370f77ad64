// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/hub.h"

#include <utility>

namespace goldthread {

Viewer Hub::join(std::function<void()> pull) {
  const Viewer viewer = session_.open();
  pulls_.emplace(viewer, std::move(pull));
  return viewer;
}

void Hub::leave(Viewer viewer) {
  pulls_.erase(viewer);
  session_.gone(viewer);
  if (pulls_.empty() && when_empty_) when_empty_();
}

void Hub::when_empty(std::function<void()> done) {
  when_empty_ = std::move(done);
  if (pulls_.empty()) when_empty_();
}

void Hub::settle() {
  for (const auto& [viewer, pull] : pulls_) pull();
  std::vector<Viewer> flooding;
  auto events = session_.take_events();
  const bool news = !events.empty();
  {
    const std::scoped_lock lock(mutex_);
    for (GatewayEvent& event : events) {
      const auto* edit = std::get_if<EditInput>(&event);
      const Viewer author = edit ? edit->viewer : 0;
      if (!events_.push(std::move(event))) flooding.push_back(author);
    }
  }
  if (news) on_event_();
  if (flooding.empty()) return;
  for (const Viewer viewer : flooding) {
    session_.close(viewer, Session::kPolicy, "edits come faster than they can be taken");
  }
  settle();
}

std::vector<GatewayEvent> Hub::take_events() {
  const std::scoped_lock lock(mutex_);
  return events_.take();
}

std::shared_ptr<void> Hub::admit() {
  if (sockets_ >= limits_.max_connections) return nullptr;
  ++sockets_;
  return std::shared_ptr<void>(this, [](Hub* hub) { --hub->sockets_; });
}

}  // namespace goldthread
