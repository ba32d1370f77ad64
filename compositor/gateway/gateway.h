// SPDX-License-Identifier: Apache-2.0
#pragma once
// The gateway: serves the page over HTTP and talks to it over a WebSocket
// (docs/viewer-protocol.md). It runs its own thread; every method returns at once and may be called
// from any thread. A slow page gets newer pictures, not more of them; a malicious one is closed.
// Who drives is decided here.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/base/types.h"
#include "common/scene/scene.h"
#include "common/tile/refinement.h"

namespace goldthread {

/// How much a page may take before it is closed.
struct GatewayLimits {
  std::size_t max_connections = 256;            ///< sockets, HTTP and WebSocket together
  std::chrono::milliseconds handshake{10'000};  ///< from connecting to a whole request, or `hello`
  std::chrono::milliseconds stalled{30'000};    ///< for one message to be taken by the page
  std::chrono::milliseconds silent{60'000};     ///< without an answer to the keep-alive pings
};

struct GatewayOptions {
  std::string host = "127.0.0.1";
  std::uint16_t port = 8080;  ///< 0: any free one
  std::string token;          ///< what a page must present; not empty
  GatewayLimits limits;
  /// Called on the gateway's thread when there are events to take; must return at once.
  std::function<void()> on_event = [] {};
};

/// One encoded part of a picture.
struct PictureRegion {
  PixelRect rect;
  std::uint8_t encoding = 0;  ///< 1 JPEG, 2 zstd RGB
  std::vector<std::byte> payload;
};

struct Picture {
  Epoch epoch;
  std::uint32_t viewer = 0;  ///< whose input is the newest in it
  std::uint32_t serial = 0;  ///< of that input
  ImageSize size;
  bool final = false;
  std::uint8_t cine_frame = 0;   ///< 1 … cine_frames: a frame of the cine loop; 0: none
  std::uint8_t cine_frames = 0;  ///< 7, or 0: no cine loop
  float estimated_error = -1;    ///< RMS in 1/255; negative: unknown
  std::vector<PictureRegion> regions;
};

/// What the driving page asked for, decoded and checked for form (finite numbers, sizes in range).
struct CameraInput {
  std::uint32_t viewer = 0, serial = 0;
  Camera camera;
};
struct EditInput {
  std::uint32_t viewer = 0, serial = 0;
  std::string edit_json;  ///< the `edit` object
};
struct SizeInput {
  std::uint32_t viewer = 0, serial = 0;
  ImageSize size;
};
struct DisplayInput {
  std::uint32_t viewer = 0, serial = 0;
  DisplaySettings display;
};
/// What a page watches beside the picture: messages of these types are sent to nobody else.
struct Watch {
  bool load = false, tiles = false;
  bool operator==(const Watch&) const = default;
};
/// How many pages are connected, whether one of them can take a picture now, and what any of them
/// watches.
struct AudienceChange {
  std::uint32_t viewers = 0;
  bool ready = false;
  Watch watch{};
  bool operator==(const AudienceChange&) const = default;
};
using GatewayEvent = std::variant<CameraInput, EditInput, SizeInput, DisplayInput, AudienceChange>;

class Gateway {
 public:
  /// Binds and starts to serve. Throws FatalError if the address cannot be had (kClusterFailed).
  explicit Gateway(GatewayOptions options);
  /// Tells the pages that the server goes away, for at most half a second, and joins its thread.
  ~Gateway();
  Gateway(const Gateway&) = delete;
  Gateway& operator=(const Gateway&) = delete;

  /// The port that was bound (the one asked for, or the one found for port 0).
  std::uint16_t port() const;

  // Malformed arguments are bugs of the caller and throw std::invalid_argument.

  /// The newest picture: each page gets it as soon as it has room, unless a newer one comes first.
  /// Pages that arrive later start with it. Frames of a cine loop do not overtake each other, but
  /// for a newer one of the same place: each page gets the whole loop. 1 … 255 regions inside the
  /// image, encodings 1 or 2, an estimated error that is a number.
  void publish(Picture picture);
  /// JSON for all pages. `welcome_json` (without viewer, driver, viewers) describes the session as
  /// it is at the call; it is kept for later pages and turns waiting ones into spectators.
  void set_welcome(std::string welcome_json);
  /// `state_json` messages of one `type` replace each other for a page that is slow. Later pages
  /// get the newest of each type since the last set_welcome, after their welcome. What is watched
  /// ("load", "tiles") goes to the pages that watch it now, and to no later ones.
  void broadcast(std::string state_json);
  /// JSON for one page; dropped if that page has gone.
  void send(std::uint32_t viewer, std::string json);

  /// What has come since the last call, in order; cameras, sizes, display settings and audience
  /// changes that a newer one of their kind overtook are left out. An audience change is the state
  /// at its place in the order: states between two calls may be skipped, the newest never is.
  std::vector<GatewayEvent> take_events();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace goldthread
