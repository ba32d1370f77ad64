// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/session.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

namespace goldthread {
namespace {

using Json = nlohmann::ordered_json;

Json message_of_ours(const std::string& text) {
  Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains("type") || !json["type"].is_string()) {
    throw std::invalid_argument("a message to a page is a JSON object with a type");
  }
  return json;
}

std::shared_ptr<const NumberedPicture> numbered(Picture picture, std::uint32_t number) {
  auto result = std::make_shared<NumberedPicture>();
  result->number = number;
  result->headers.reserve(picture.regions.size());
  for (std::size_t i = 0; i < picture.regions.size(); ++i) {
    result->headers.push_back(encode(region_header(picture, i, number)));
  }
  result->picture = std::move(picture);
  return result;
}

/// Are these two places of one cine loop?
bool side_by_side(const Picture& a, const Picture& b) {
  return a.cine_frame > 0 && b.cine_frame > 0 && a.cine_frame != b.cine_frame && a.size == b.size;
}

// A loop that lacks a frame is none, so that its frames are not overtaken by each other.
void add_newest(Pictures& pictures, const std::shared_ptr<const NumberedPicture>& newest) {
  std::erase_if(pictures,
                [&](const auto& older) { return !side_by_side(older->picture, newest->picture); });
  pictures.push_back(newest);
}

/// The messages that a page gets only while it watches, by their type.
struct Watched {
  std::string_view type;
  bool Watch::*wanted;
};
constexpr Watched kWatched[] = {{"load", &Watch::load}, {"tiles", &Watch::tiles}};

}  // namespace

Viewer Session::open() {
  pages_.emplace(++last_viewer_, Page{});
  return last_viewer_;
}

void Session::gone(Viewer viewer) {
  leave(viewer);
  pages_.erase(viewer);
}

void Session::close(Viewer viewer, std::uint16_t code, std::string reason) {
  const auto found = pages_.find(viewer);
  if (found == pages_.end() || found->second.stage >= Stage::kClosing) return;
  leave(viewer);
  found->second = Page{};
  found->second.stage = Stage::kClosing;
  found->second.close = CloseFrame{code, std::move(reason)};
}

void Session::close_all(std::uint16_t code, const std::string& reason) {
  for (const auto& entry : pages_) close(entry.first, code, reason);
}

bool Session::greeted(Viewer viewer) const {
  const auto found = pages_.find(viewer);
  return found != pages_.end() && found->second.stage != Stage::kConnected;
}

// ---- who is there

std::uint32_t Session::present_count() const {
  return static_cast<std::uint32_t>(std::count_if(
      pages_.begin(), pages_.end(), [](const auto& entry) { return present(entry.second); }));
}

AudienceChange Session::audience() const {
  const bool ready = std::any_of(pages_.begin(), pages_.end(), [](const auto& entry) {
    const Page& page = entry.second;
    return page.stage == Stage::kWatching && page.unacknowledged.size() < kMaxUnacknowledged &&
           page.waiting.empty();
  });
  Watch watch;
  for (const auto& [viewer, page] : pages_) {
    if (!present(page)) continue;
    for (const Watched& kind : kWatched)
      watch.*kind.wanted = watch.*kind.wanted || page.watch.*kind.wanted;
  }
  return {present_count(), ready, watch};
}

void Session::leave(Viewer viewer) {
  const auto found = pages_.find(viewer);
  if (found == pages_.end() || !present(found->second)) return;
  found->second.stage = Stage::kClosed;
  if (driver_ == viewer) {
    const auto heir = std::find_if(pages_.begin(), pages_.end(),
                                   [](const auto& entry) { return present(entry.second); });
    driver_ = heir == pages_.end() ? 0 : heir->first;
  }
  tell_driver(0);
}

void Session::tell_driver(Viewer except) {
  const auto text = shared_text(
      Json{{"type", "driver"}, {"driver", driver_}, {"viewers", present_count()}}.dump());
  for (auto& [viewer, page] : pages_) {
    if (viewer != except && page.stage == Stage::kWatching) {
      enqueue(viewer, page, {"driver", text});
    }
  }
}

void Session::welcome(Viewer viewer, Page& page) {
  page.stage = Stage::kWatching;
  // What the page was still to be told about the time before is overtaken by the welcome.
  std::erase_if(page.texts, [&](const QueuedText& queued) {
    if (queued.type.empty()) return false;
    page.text_bytes -= queued.text->size();
    return true;
  });
  const Json numbers{{"viewer", viewer}, {"driver", driver_}, {"viewers", present_count()}};
  std::string text = numbers.dump();
  text.back() = ',';
  enqueue(viewer, page, {"", shared_text(text + welcome_)});
  for (const Retained& state : retained_) {
    if (state.type != "loading") enqueue(viewer, page, {state.type, state.text});
  }
  if (page.stage == Stage::kWatching) page.waiting = newest_;
}

// ---- what the program says

void Session::set_welcome(const std::string& welcome_json) {
  Json json = message_of_ours(welcome_json);
  for (const char* ours : {"viewer", "driver", "viewers"}) json.erase(ours);
  welcome_ = json.dump().substr(1);
  retained_.clear();
  for (auto& [viewer, page] : pages_) {
    if (page.stage == Stage::kWaiting) welcome(viewer, page);
  }
}

void Session::broadcast(const std::string& state_json) {
  const Json json = message_of_ours(state_json);
  const std::string type = json["type"];
  const auto text = shared_text(state_json);
  for (const Watched& kind : kWatched) {
    if (type != kind.type) continue;
    for (auto& [viewer, page] : pages_) {
      if (page.stage == Stage::kWatching && page.watch.*kind.wanted)
        enqueue(viewer, page, {type, text});
    }
    return;
  }
  const auto found = std::find_if(retained_.begin(), retained_.end(),
                                  [&](const Retained& state) { return state.type == type; });
  if (found == retained_.end()) {
    retained_.push_back({type, text});
  } else {
    found->text = text;
  }
  for (auto& [viewer, page] : pages_) {
    if (present(page)) enqueue(viewer, page, {type, text});
  }
}

void Session::send(Viewer viewer, std::string json) {
  message_of_ours(json);
  const auto found = pages_.find(viewer);
  if (found == pages_.end() || !present(found->second)) return;
  enqueue(viewer, found->second, {"", shared_text(std::move(json))});
}

void Session::publish(Picture picture) {
  check_picture(picture);
  const auto newest = numbered(std::move(picture), ++last_picture_);
  add_newest(newest_, newest);
  for (auto& [viewer, page] : pages_) {
    if (page.stage == Stage::kWatching) add_newest(page.waiting, newest);
  }
}

// ---- what a page is told next

void Session::enqueue(Viewer viewer, Page& page, QueuedText text) {
  if (page.stage >= Stage::kClosing) return;
  const std::size_t bytes = text.text->size();
  const auto same = std::find_if(page.texts.begin(), page.texts.end(), [&](const QueuedText& old) {
    return !text.type.empty() && old.type == text.type;
  });
  if (same != page.texts.end()) {
    page.text_bytes -= same->text->size();
    *same = std::move(text);
  } else {
    page.texts.push_back(std::move(text));
  }
  page.text_bytes += bytes;
  if (page.texts.size() > kMaxQueuedTexts || page.text_bytes > kMaxQueuedBytes) {
    close(viewer, kPolicy, "the page does not read what it is sent");
  }
}

std::optional<Frame> Session::next_frame(Viewer viewer) {
  const auto found = pages_.find(viewer);
  if (found == pages_.end()) return std::nullopt;
  Page& page = found->second;
  if (!page.texts.empty()) {
    TextFrame frame{std::move(page.texts.front().text)};
    page.texts.pop_front();
    page.text_bytes -= frame.text->size();
    return frame;
  }
  if (page.close) {
    page.stage = Stage::kClosed;
    return *std::exchange(page.close, std::nullopt);
  }
  return next_region(page);
}

std::optional<Frame> Session::next_region(Page& page) {
  if (!page.sending && !page.waiting.empty() && page.unacknowledged.size() < kMaxUnacknowledged) {
    page.sending = std::move(page.waiting.front());
    page.waiting.pop_front();
    page.next_region = 0;
    page.last_begun = page.sending->number;
    page.unacknowledged.push_back(page.last_begun);
  }
  if (!page.sending) return std::nullopt;
  RegionFrame frame{page.sending, page.next_region++};
  if (page.next_region == page.sending->headers.size()) page.sending = nullptr;
  return frame;
}

std::vector<GatewayEvent> Session::take_events() {
  const AudienceChange now = audience();
  if (now != reported_) {
    reported_ = now;
    events_.push_back(now);
  }
  return std::exchange(events_, {});
}

}  // namespace goldthread
