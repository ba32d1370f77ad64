// SPDX-License-Identifier: Apache-2.0
#include "compositor/encode.h"

#include <turbojpeg.h>
#include <zstd.h>

#include <memory>
#include <string>

#include "common/base/result.h"

namespace goldthread {
namespace {

/// High enough that smooth shading shows no blocks; a picture in motion is replaced soon anyway.
constexpr int kJpegQuality = 88;
/// The fastest level: the picture at rest should come at once, and gains little from more.
constexpr int kZstdLevel = 1;

[[noreturn]] void fail(const char* call, const std::string& what) {
  throw FatalError({call, what, "", ExitStatus::kClusterFailed});
}

}  // namespace

struct Encoder::Libraries {
  std::unique_ptr<void, int (*)(tjhandle)> jpeg{tjInitCompress(), tjDestroy};
  std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> zstd{ZSTD_createCCtx(), ZSTD_freeCCtx};
};

namespace {

Buffer jpeg(tjhandle compressor, std::span<const std::uint8_t> rgb, ImageSize size) {
  Buffer bytes(tjBufSize(size.width, size.height, TJSAMP_444));
  auto* out = reinterpret_cast<unsigned char*>(bytes.data());
  unsigned long length = bytes.size();
  if (tjCompress2(compressor, rgb.data(), size.width, 0, size.height, TJPF_RGB, &out, &length,
                  TJSAMP_444, kJpegQuality, TJFLAG_NOREALLOC | TJFLAG_FASTDCT) != 0) {
    fail("tjCompress2", tjGetErrorStr2(compressor));
  }
  bytes.truncate(length);
  return bytes;
}

Buffer zstd(ZSTD_CCtx* context, std::span<const std::uint8_t> rgb) {
  Buffer bytes(ZSTD_compressBound(rgb.size()));
  const std::size_t length =
      ZSTD_compressCCtx(context, bytes.data(), bytes.size(), rgb.data(), rgb.size(), kZstdLevel);
  if (ZSTD_isError(length) != 0) fail("ZSTD_compressCCtx", ZSTD_getErrorName(length));
  bytes.truncate(length);
  return bytes;
}

}  // namespace

Encoder::Encoder() : libraries_(std::make_unique<Libraries>()) {
  if (!libraries_->jpeg) fail("tjInitCompress", tjGetErrorStr2(nullptr));
  if (!libraries_->zstd) fail("ZSTD_createCCtx", "no memory");
}
Encoder::~Encoder() = default;

Buffer Encoder::encode(std::span<const std::uint8_t> rgb, ImageSize size, Encoding encoding) {
  return encoding == Encoding::kJpeg ? jpeg(libraries_->jpeg.get(), rgb, size)
                                     : zstd(libraries_->zstd.get(), rgb);
}

Buffer encode_pixels(std::span<const std::uint8_t> rgb, ImageSize size, Encoding encoding) {
  return Encoder().encode(rgb, size, encoding);
}

}  // namespace goldthread
