// SPDX-License-Identifier: Apache-2.0
#pragma once
// The rules of a session, without sockets and clocks: who is connected, who drives, what each page
// is told next. Frames are pulled, one at a time, by whoever writes them, so that what waits for a
// slow page lies here and is bounded: one message per type of state, a limited number of answers,
// one picture or the frames of one cine loop. A picture that was begun is finished before another
// starts.

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "compositor/gateway/gateway.h"
#include "compositor/gateway/page_message.h"
#include "compositor/gateway/region_codec.h"

namespace goldthread {

/// Numbers a page: 1, 2, … in the order of connecting, never used again.
using Viewer = std::uint32_t;

/// A picture as it is sent: shared by all pages, never changed.
struct NumberedPicture {
  std::uint32_t number = 0;
  Picture picture;
  std::vector<RegionHeaderBytes> headers;
};

/// What a page that has shown nothing yet is to show: the newest picture, or the newest of each
/// frame of a cine loop. Oldest first.
using Pictures = std::deque<std::shared_ptr<const NumberedPicture>>;

struct TextFrame {
  std::shared_ptr<const std::string> text;
};
inline std::shared_ptr<const std::string> shared_text(std::string text) {
  return std::make_shared<const std::string>(std::move(text));
}
struct RegionFrame {
  std::shared_ptr<const NumberedPicture> picture;
  std::size_t region = 0;
};
/// The last frame of a page; `reason` fits a WebSocket close frame.
struct CloseFrame {
  std::uint16_t code = 0;
  std::string reason;
};
using Frame = std::variant<TextFrame, RegionFrame, CloseFrame>;

class Session {
 public:
  static constexpr std::size_t kMaxUnacknowledged = 2;
  static constexpr std::size_t kMaxQueuedTexts = 256;
  static constexpr std::size_t kMaxQueuedBytes = std::size_t{32} << 20;

  static constexpr std::uint16_t kGoingAway = 1001;
  static constexpr std::uint16_t kPolicy = 1008;

  // What happens to pages.
  Viewer open();
  void receive_text(Viewer viewer, std::string_view text);
  void receive_binary(Viewer viewer);
  void gone(Viewer viewer);
  /// Closes with what is queued left out. Harmless for a page that is closing or gone.
  void close(Viewer viewer, std::uint16_t code, std::string reason);
  void close_all(std::uint16_t code, const std::string& reason);
  /// Has the page said `hello`? Until then it is nobody.
  bool greeted(Viewer viewer) const;

  // What the program says; see Gateway. Malformed arguments throw std::invalid_argument.
  void set_welcome(const std::string& welcome_json);
  void broadcast(const std::string& state_json);
  void send(Viewer viewer, std::string json);
  void publish(Picture picture);

  /// What to write to a page next, if anything; call again when it is written.
  std::optional<Frame> next_frame(Viewer viewer);

  /// What the driving page asked for since the last call, and how the audience changed. To be
  /// called when every page that can write has pulled its frames.
  std::vector<GatewayEvent> take_events();

 private:
  enum class Stage { kConnected, kWaiting, kWatching, kClosing, kClosed };
  struct QueuedText {
    std::string type;  ///< of a state that a newer one replaces; empty: never replaced
    std::shared_ptr<const std::string> text;
  };
  struct Page {
    Stage stage = Stage::kConnected;
    std::uint32_t serial = 0;  ///< of its last input
    Watch watch;
    std::deque<QueuedText> texts;
    std::size_t text_bytes = 0;
    std::deque<std::uint32_t> unacknowledged;        ///< pictures begun, oldest first
    std::shared_ptr<const NumberedPicture> sending;  ///< begun, not all regions pulled
    std::size_t next_region = 0;
    Pictures waiting;  ///< the newest that have no room yet
    std::uint32_t last_begun = 0;
    std::optional<CloseFrame> close;
  };
  struct Retained {
    std::string type;
    std::shared_ptr<const std::string> text;
  };

  static bool present(const Page& page) {
    return page.stage == Stage::kWaiting || page.stage == Stage::kWatching;
  }
  std::uint32_t present_count() const;
  AudienceChange audience() const;

  void handle(Viewer viewer, Page& page, const page::Hello& hello);
  void handle(Viewer viewer, Page& page, const page::MoveCamera& move);
  void handle(Viewer viewer, Page& page, const page::Edit& edit);
  void handle(Viewer viewer, Page& page, const page::Resize& resize);
  void handle(Viewer viewer, Page& page, const page::Display& display);
  void handle(Viewer viewer, Page& page, const page::Drive& drive);
  void handle(Viewer viewer, Page& page, const page::Watch& watch);
  void handle(Viewer viewer, Page& page, const page::Ack& ack);
  void handle(Viewer viewer, Page& page, const page::Ping& ping);

  /// Does this input count: its serial grows (else the page is closed) and the page drives?
  bool accepts_input(Viewer viewer, Page& page, std::uint32_t serial);
  void refuse(Viewer viewer, Page& page, std::uint32_t serial, const Failure& failure);
  void welcome(Viewer viewer, Page& page);
  void leave(Viewer viewer);
  void tell_driver(Viewer except);
  void enqueue(Viewer viewer, Page& page, QueuedText text);
  std::optional<Frame> next_region(Page& page);

  std::map<Viewer, Page> pages_;
  Viewer last_viewer_ = 0;
  Viewer driver_ = 0;
  std::string welcome_;             ///< an object's text without its opening brace; empty: none yet
  std::vector<Retained> retained_;  ///< the newest state of each type since the welcome was set
  Pictures newest_;
  std::uint32_t last_picture_ = 0;
  std::vector<GatewayEvent> events_;
  AudienceChange reported_;
};

}  // namespace goldthread
