// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/region_codec.h"

#include <bit>
#include <cmath>
#include <stdexcept>

namespace goldthread {
namespace {

constexpr std::uint32_t kMagic = 0x47525447;
constexpr std::int32_t kMaxSide = 65535;
constexpr std::uint8_t kLoopFrames = 7;
constexpr std::uint8_t kZero = 0;

class Writer {
 public:
  explicit Writer(RegionHeaderBytes& bytes) : bytes_(bytes) {}
  template <class T>
  void put(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bytes_[at_++] = static_cast<std::byte>((static_cast<std::uint64_t>(value) >> (8 * i)) & 0xff);
    }
  }

 private:
  RegionHeaderBytes& bytes_;
  std::size_t at_ = 0;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <class T>
  T get() {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      value |= std::to_integer<std::uint64_t>(bytes_[at_++]) << (8 * i);
    }
    return static_cast<T>(value);
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

Failure bad(const char* what) { return {"region header", what, ""}; }

bool inside(const PixelRect& rect, const ImageSize& size) {
  return rect.x >= 0 && rect.y >= 0 && rect.width > 0 && rect.height > 0 &&
         rect.width <= size.width && rect.height <= size.height &&
         rect.x <= size.width - rect.width && rect.y <= size.height - rect.height;
}

/// Whether a picture can have this place in a loop, or none.
bool cine_place(std::uint8_t frame, std::uint8_t frames) {
  return frames == 0 ? frame == 0 : frames == kLoopFrames && frame >= 1 && frame <= frames;
}

/// Why a header whose bytes are read cannot be, or nullptr.
const char* contradiction(const RegionHeader& header) {
  if (header.encoding != 1 && header.encoding != 2) return "the encoding is unknown";
  if (header.index >= header.count) return "the index is not below the count";
  if (!cine_place(header.cine_frame, header.cine_frames)) return "the cine frame is not in a loop";
  if (std::isnan(header.estimated_error)) return "the estimated error is not a number";
  const bool in_image = inside({header.x, header.y, header.width, header.height},
                               {header.image_width, header.image_height});
  return in_image ? nullptr : "the region is not inside the image";
}

}  // namespace

RegionHeaderBytes encode(const RegionHeader& header) {
  RegionHeaderBytes bytes{};
  Writer out(bytes);
  out.put(kMagic);
  out.put(header.picture);
  out.put(header.epoch);
  out.put(header.viewer);
  out.put(header.serial);
  out.put(header.x);
  out.put(header.y);
  out.put(header.width);
  out.put(header.height);
  out.put(header.image_width);
  out.put(header.image_height);
  out.put(header.encoding);
  out.put(header.index);
  out.put(header.count);
  out.put(kZero);
  out.put(static_cast<std::uint8_t>(header.final ? 1 : 0));
  out.put(header.cine_frame);
  out.put(header.cine_frames);
  out.put(kZero);
  out.put(std::bit_cast<std::uint32_t>(header.estimated_error));
  return bytes;
}

Result<RegionHeader> decode_region_header(std::span<const std::byte> message) {
  if (message.size() < kRegionHeaderBytes) return bad("is shorter than 44 bytes");
  Reader in(message);
  if (in.get<std::uint32_t>() != kMagic) return bad("does not start with the magic number");
  RegionHeader header;
  header.picture = in.get<std::uint32_t>();
  header.epoch = in.get<std::uint32_t>();
  header.viewer = in.get<std::uint32_t>();
  header.serial = in.get<std::uint32_t>();
  header.x = in.get<std::uint16_t>();
  header.y = in.get<std::uint16_t>();
  header.width = in.get<std::uint16_t>();
  header.height = in.get<std::uint16_t>();
  header.image_width = in.get<std::uint16_t>();
  header.image_height = in.get<std::uint16_t>();
  header.encoding = in.get<std::uint8_t>();
  header.index = in.get<std::uint8_t>();
  header.count = in.get<std::uint8_t>();
  const auto before_final = in.get<std::uint8_t>();
  const auto final = in.get<std::uint8_t>();
  if (final > 1) return bad("`final` is neither 0 nor 1");
  header.final = final == 1;
  header.cine_frame = in.get<std::uint8_t>();
  header.cine_frames = in.get<std::uint8_t>();
  const auto before_error = in.get<std::uint8_t>();
  if (before_final != kZero || before_error != kZero) return bad("a reserved byte is not zero");
  header.estimated_error = std::bit_cast<float>(in.get<std::uint32_t>());
  if (const char* what = contradiction(header)) return bad(what);
  return header;
}

RegionHeader region_header(const Picture& picture, std::size_t region, std::uint32_t number) {
  const PictureRegion& part = picture.regions.at(region);
  const auto u16 = [](std::int32_t value) { return static_cast<std::uint16_t>(value); };
  return {.picture = number,
          .epoch = picture.epoch.value,
          .viewer = picture.viewer,
          .serial = picture.serial,
          .x = u16(part.rect.x),
          .y = u16(part.rect.y),
          .width = u16(part.rect.width),
          .height = u16(part.rect.height),
          .image_width = u16(picture.size.width),
          .image_height = u16(picture.size.height),
          .encoding = part.encoding,
          .index = static_cast<std::uint8_t>(region),
          .count = static_cast<std::uint8_t>(picture.regions.size()),
          .final = picture.final,
          .cine_frame = picture.cine_frame,
          .cine_frames = picture.cine_frames,
          .estimated_error = picture.estimated_error};
}

void check_picture(const Picture& picture) {
  if (picture.regions.empty() || picture.regions.size() > kMaxRegions) {
    throw std::invalid_argument("a picture has 1 … 255 regions");
  }
  if (picture.size.width > kMaxSide || picture.size.height > kMaxSide) {
    throw std::invalid_argument("a picture has at most 65535 pixels a side");
  }
  if (!cine_place(picture.cine_frame, picture.cine_frames)) {
    throw std::invalid_argument("a picture is one of 7 cine frames, or none");
  }
  if (std::isnan(picture.estimated_error)) {
    throw std::invalid_argument("a picture's estimated error is a number");
  }
  for (const PictureRegion& region : picture.regions) {
    if (!inside(region.rect, picture.size)) {
      throw std::invalid_argument("a region lies inside its picture");
    }
    if (region.encoding != 1 && region.encoding != 2) {
      throw std::invalid_argument("a region's encoding is 1 or 2");
    }
  }
}

}  // namespace goldthread
