// SPDX-License-Identifier: Apache-2.0
// What pages say to a session: one overload of `handle` for each message.

#include <algorithm>
#include <nlohmann/json.hpp>

#include "compositor/gateway/session.h"

namespace goldthread {

namespace {
using Json = nlohmann::ordered_json;
}  // namespace

void Session::receive_text(Viewer viewer, std::string_view text) {
  const auto found = pages_.find(viewer);
  if (found == pages_.end() || found->second.stage >= Stage::kClosing) return;
  const Result<page::Message> message = page::decode(text);
  if (!message) {
    close(viewer, kPolicy, message.failure().where + " " + message.failure().what);
    return;
  }
  if (found->second.stage == Stage::kConnected && !std::holds_alternative<page::Hello>(*message)) {
    close(viewer, kPolicy, "hello must come first");
    return;
  }
  std::visit([&](const auto& known) { handle(viewer, found->second, known); }, *message);
}

void Session::receive_binary(Viewer viewer) {
  close(viewer, kPolicy, "pages send no binary messages");
}

void Session::handle(Viewer viewer, Page& page, const page::Hello& hello) {
  if (page.stage != Stage::kConnected) {
    close(viewer, kPolicy, "hello comes once");
    return;
  }
  if (hello.protocol != page::kProtocol) {
    refuse(viewer, page, 0,
           {"hello.protocol", "this server speaks protocol " + std::to_string(page::kProtocol),
            "reload the page"});
    page.stage = Stage::kClosing;
    page.close = CloseFrame{kPolicy, "wrong protocol"};
    return;
  }
  page.stage = Stage::kWaiting;
  if (driver_ == 0) driver_ = viewer;
  tell_driver(viewer);
  if (!welcome_.empty()) {
    welcome(viewer, page);
    return;
  }
  const bool loading_known =
      std::any_of(retained_.begin(), retained_.end(),
                  [](const Retained& state) { return state.type == "loading"; });
  if (!loading_known) {
    enqueue(viewer, page,
            {"loading", shared_text(R"({"type":"loading","what":"volume","done":0,"total":0})")});
  }
  for (const Retained& state : retained_) enqueue(viewer, page, {state.type, state.text});
}

void Session::handle(Viewer viewer, Page& page, const page::MoveCamera& move) {
  if (!accepts_input(viewer, page, move.serial)) return;
  if (const auto failure = page::refusal(move.camera)) {
    refuse(viewer, page, move.serial, *failure);
    return;
  }
  events_.push_back(CameraInput{viewer, move.serial, move.camera});
}

void Session::handle(Viewer viewer, Page& page, const page::Edit& edit) {
  if (!accepts_input(viewer, page, edit.serial)) return;
  events_.push_back(EditInput{viewer, edit.serial, edit.edit_json});
}

void Session::handle(Viewer viewer, Page& page, const page::Resize& resize) {
  if (!accepts_input(viewer, page, resize.serial)) return;
  if (const auto failure = page::refusal(resize)) {
    refuse(viewer, page, resize.serial, *failure);
    return;
  }
  events_.push_back(SizeInput{
      viewer,
      resize.serial,
      {static_cast<std::int32_t>(resize.width), static_cast<std::int32_t>(resize.height)}});
}

void Session::handle(Viewer viewer, Page& page, const page::Display& display) {
  if (!accepts_input(viewer, page, display.serial)) return;
  const Result<DisplaySettings> settings = page::settings_of(display);
  if (!settings) {
    refuse(viewer, page, display.serial, settings.failure());
    return;
  }
  events_.push_back(DisplayInput{viewer, display.serial, *settings});
}

void Session::handle(Viewer viewer, Page&, const page::Drive&) {
  if (driver_ == viewer) return;
  driver_ = viewer;
  tell_driver(0);
}

void Session::handle(Viewer, Page& page, const page::Watch& watch) {
  page.watch = {watch.load, watch.tiles};
}

void Session::handle(Viewer viewer, Page& page, const page::Ack& ack) {
  if (ack.picture > page.last_begun) {
    close(viewer, kPolicy, "ack of a picture that was never sent");
    return;
  }
  // A page that shows a picture will not show an older one any more.
  while (!page.unacknowledged.empty() && page.unacknowledged.front() <= ack.picture) {
    page.unacknowledged.pop_front();
  }
}

void Session::handle(Viewer viewer, Page& page, const page::Ping& ping) {
  enqueue(viewer, page, {"", shared_text(Json{{"type", "pong"}, {"time", ping.time}}.dump())});
}

bool Session::accepts_input(Viewer viewer, Page& page, std::uint32_t serial) {
  if (serial <= page.serial) {
    close(viewer, kPolicy, "serial does not grow");
    return false;
  }
  page.serial = serial;
  return viewer == driver_;
}

void Session::refuse(Viewer viewer, Page& page, std::uint32_t serial, const Failure& failure) {
  const Json json{{"type", "refused"},
                  {"serial", serial},
                  {"where", failure.where},
                  {"what", failure.what},
                  {"mend", failure.mend}};
  enqueue(viewer, page, {"", shared_text(json.dump())});
}

}  // namespace goldthread
