// SPDX-License-Identifier: Apache-2.0
#pragma once
// Pixels to bytes for a viewer: JPEG while the view moves, zstd without loss when it rests.

#include <cstdint>
#include <memory>
#include <span>

#include "common/base/types.h"
#include "common/protocol/messages.h"

namespace goldthread {

enum class Encoding : std::uint8_t { kJpeg = 1, kZstdRgb = 2 };

/// How a picture is to be encoded.
inline Encoding encoding_of(const Present& present) {
  return present.lossless ? Encoding::kZstdRgb : Encoding::kJpeg;
}

/// Keeps what the libraries need from one picture to the next.
class Encoder {
 public:
  Encoder();
  ~Encoder();
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;
  /// As encode_pixels().
  Buffer encode(std::span<const std::uint8_t> rgb, ImageSize size, Encoding encoding);

 private:
  struct Libraries;
  std::unique_ptr<Libraries> libraries_;
};

/// `rgb`: size.width · size.height · 3 bytes, rows from the top. Throws FatalError if the library
/// refuses, which it does only without memory.
Buffer encode_pixels(std::span<const std::uint8_t> rgb, ImageSize size, Encoding encoding);

}  // namespace goldthread
