// SPDX-License-Identifier: Apache-2.0
#pragma once
// The 44 bytes in front of each region of a picture (docs/viewer-protocol.md, "Regions"). Little
// endian on every machine; decode accepts exactly what encode can produce.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/base/result.h"
#include "compositor/gateway/gateway.h"

namespace goldthread {

inline constexpr std::size_t kRegionHeaderBytes = 44;
inline constexpr std::size_t kMaxRegions = 255;

struct RegionHeader {
  std::uint32_t picture = 0;  ///< number of the picture
  std::uint32_t epoch = 0;
  std::uint32_t viewer = 0;
  std::uint32_t serial = 0;
  std::uint16_t x = 0, y = 0, width = 0, height = 0;  ///< of the region, pixels from the top left
  std::uint16_t image_width = 0, image_height = 0;
  std::uint8_t encoding = 0;  ///< 1 JPEG, 2 zstd RGB
  std::uint8_t index = 0;
  std::uint8_t count = 0;
  bool final = false;
  std::uint8_t cine_frame = 0;
  std::uint8_t cine_frames = 0;
  float estimated_error = -1;  ///< RMS in 1/255; negative: unknown
  bool operator==(const RegionHeader&) const = default;
};

using RegionHeaderBytes = std::array<std::byte, kRegionHeaderBytes>;

RegionHeaderBytes encode(const RegionHeader& header);

/// The header at the start of a message, or what is wrong with it.
Result<RegionHeader> decode_region_header(std::span<const std::byte> message);

/// The header of one region of a picture. The picture must pass check_picture.
RegionHeader region_header(const Picture& picture, std::size_t region, std::uint32_t number);

/// Throws std::invalid_argument, a bug of the caller, unless the picture can be sent: 1 … 255
/// regions inside an image of at most 65535 pixels a side, encodings 1 or 2, a possible place in a
/// cine loop, an error that is a number.
void check_picture(const Picture& picture);

}  // namespace goldthread
