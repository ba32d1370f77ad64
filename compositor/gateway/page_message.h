// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a page may say (docs/viewer-protocol.md, "Page to gateway"), decoded from JSON. Decoding
// checks form: size, nesting, UTF-8, types, finite numbers; whatever fails is no page of ours and
// is closed. Values of good form but out of range are a user's mistake and are refused instead.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "common/base/result.h"
#include "common/base/types.h"
#include "common/scene/scene.h"
#include "common/tile/refinement.h"

namespace goldthread::page {

inline constexpr std::uint32_t kProtocol = 2;
inline constexpr std::size_t kMaxMessageBytes = std::size_t{1} << 20;
inline constexpr int kMaxNesting = 16;
inline constexpr std::int64_t kMinSide_px = 16;
inline constexpr std::int64_t kMaxSide_px = 4096;

struct Hello {
  std::int64_t protocol = 0;
};
struct MoveCamera {
  std::uint32_t serial = 0;
  Camera camera;
};
struct Edit {
  std::uint32_t serial = 0;
  std::string edit_json;  ///< the `edit` object
};
struct Resize {
  std::uint32_t serial = 0;
  std::int64_t width = 0, height = 0;
};
struct Display {
  std::uint32_t serial = 0;
  std::string filter, update;  ///< names of the protocol, or anything else
  bool cine = false;
};
struct Drive {};
/// What the page wants to be told from now on; see Session.
struct Watch {
  bool load = false, tiles = false;
};
struct Ack {
  std::uint32_t picture = 0;
};
struct Ping {
  double time = 0;
};
using Message = std::variant<Hello, MoveCamera, Edit, Resize, Display, Drive, Watch, Ack, Ping>;

/// The message in `text`, or what is wrong with its form. Reasons never repeat the page's text.
Result<Message> decode(std::string_view text);

/// Why this camera cannot be rendered from (finite, but degenerate or out of range), if so.
std::optional<Failure> refusal(const Camera& camera);
/// Why an image cannot have this size, if so.
std::optional<Failure> refusal(const Resize& resize);
/// The settings that a page named, or why there are none of these names.
Result<DisplaySettings> settings_of(const Display& display);

}  // namespace goldthread::page
