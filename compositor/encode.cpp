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

Buffer jpeg(std::span<const std::uint8_t> rgb, ImageSize size) {
  const std::unique_ptr<void, int (*)(tjhandle)> compressor(tjInitCompress(), tjDestroy);
  if (!compressor) fail("tjInitCompress", tjGetErrorStr2(nullptr));
  Buffer bytes(tjBufSize(size.width, size.height, TJSAMP_444));
  auto* out = reinterpret_cast<unsigned char*>(bytes.data());
  unsigned long length = bytes.size();
  if (tjCompress2(compressor.get(), rgb.data(), size.width, 0, size.height, TJPF_RGB, &out, &length,
                  TJSAMP_444, kJpegQuality, TJFLAG_NOREALLOC | TJFLAG_FASTDCT) != 0) {
    fail("tjCompress2", tjGetErrorStr2(compressor.get()));
  }
  bytes.truncate(length);
  return bytes;
}

Buffer zstd(std::span<const std::uint8_t> rgb) {
  Buffer bytes(ZSTD_compressBound(rgb.size()));
  const std::size_t length =
      ZSTD_compress(bytes.data(), bytes.size(), rgb.data(), rgb.size(), kZstdLevel);
  if (ZSTD_isError(length) != 0) fail("ZSTD_compress", ZSTD_getErrorName(length));
  bytes.truncate(length);
  return bytes;
}

}  // namespace

Buffer encode_pixels(std::span<const std::uint8_t> rgb, ImageSize size, Encoding encoding) {
  return encoding == Encoding::kJpeg ? jpeg(rgb, size) : zstd(rgb);
}

}  // namespace goldthread
