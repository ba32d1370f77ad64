// SPDX-License-Identifier: Apache-2.0
#pragma once
// The gateway: serves the page over HTTP and talks to it over a WebSocket (docs/viewer-protocol.md).
// It runs its own thread; every method returns at once and may be called from any thread. A slow
// page gets newer pictures, not more of them; a malicious one is closed. Who drives is decided here.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/base/types.h"
#include "common/scene/scene.h"

namespace goldthread {

struct GatewayOptions {
  std::string host = "127.0.0.1";
  std::uint16_t port = 8080;
  std::string token;  ///< what a page must present
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
  std::uint8_t spacing_px = 1;
  bool final = false;
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
/// How many pages are connected, and whether one of them can take a picture now.
struct AudienceChange {
  std::uint32_t viewers = 0;
  bool ready = false;
};
using GatewayEvent = std::variant<CameraInput, EditInput, SizeInput, AudienceChange>;

class Gateway {
 public:
  /// Binds and starts to serve. Throws FatalError if the address cannot be had.
  explicit Gateway(GatewayOptions options);
  ~Gateway();
  Gateway(const Gateway&) = delete;
  Gateway& operator=(const Gateway&) = delete;

  /// The port that was bound (the one asked for, or the one found for port 0).
  std::uint16_t port() const;

  /// The newest picture: each page gets it as soon as it has room, unless a newer one comes first.
  void publish(Picture picture);
  /// JSON for all pages. `welcome_json` (without viewer, driver, viewers) is kept for later pages
  /// and turns waiting ones into spectators; `state_json` messages of one `type` replace each other
  /// for a page that is slow.
  void set_welcome(std::string welcome_json);
  void broadcast(std::string state_json);
  /// JSON for one page.
  void send(std::uint32_t viewer, std::string json);

  /// What has come since the last call, in order; camera inputs that a newer one of the same page
  /// overtook are left out.
  std::vector<GatewayEvent> take_events();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace goldthread
