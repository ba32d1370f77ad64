// SPDX-License-Identifier: Apache-2.0
#include "common/volume/gzip_file.h"

#include <fmt/format.h>
#include <libdeflate.h>
#include <zlib.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <new>
#include <vector>

#include "common/volume/volume_checks.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestAtOnce = std::size_t(1) << 28;
constexpr std::size_t kChunk = std::size_t(1) << 22;
constexpr std::size_t kShortestGzip = 18;  // header and trailer

// The length of the last member as its trailer has it, little endian, modulo 2^32.
std::uint32_t trailer_length(const std::byte* end) {
  std::uint32_t length = 0;
  for (int i = 1; i <= 4; ++i) length = length << 8 | std::uint32_t(end[-i]);
  return length;
}

// Whether `file` is one gzip member of exactly out.size() bytes, which are now in `out`.
bool inflate_at_once(const fs::path& file, std::span<std::byte> out) {
  std::error_code error;
  const std::uint64_t size = fs::file_size(file, error);
  if (error || size < kShortestGzip || size > kLargestAtOnce || out.size() > kLargestAtOnce)
    return false;
  const std::unique_ptr<std::byte[]> packed(new (std::nothrow) std::byte[size]);
  std::ifstream stream(file, std::ios::binary);
  if (!packed || !stream.read(reinterpret_cast<char*>(packed.get()), std::streamsize(size)) ||
      trailer_length(packed.get() + size) != out.size())
    return false;
  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> inflater(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  // Without a place for the actual length, any other length is an error.
  return inflater && libdeflate_gzip_decompress(inflater.get(), packed.get(), size, out.data(),
                                                out.size(), nullptr) == LIBDEFLATE_SUCCESS;
}

}  // namespace

std::optional<Failure> inflate_file(const fs::path& file, std::span<std::byte> out,
                                    const std::function<void(double)>& progress) {
  if (inflate_at_once(file, out)) {
    if (progress) progress(1.0);
    return std::nullopt;
  }
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> stream(gzopen(file.c_str(), "rb"), gzclose);
  if (!stream) return failure_of(file, "it cannot be opened", "check that it may be read");
  gzbuffer(stream.get(), unsigned(kChunk / 4));
  const auto truncated = [&](std::size_t done) {
    return failure_of(
        file, fmt::format("its data ends or is damaged after {} of {} bytes", done, out.size()),
        "the file is truncated: copy it again");
  };
  std::size_t done = 0;
  while (done < out.size()) {
    const auto wanted = unsigned(std::min(kChunk, out.size() - done));
    const int got = gzread(stream.get(), out.data() + done, wanted);
    if (got <= 0) return truncated(done);
    done += std::size_t(got);
    if (progress) progress(double(done) / double(out.size()));
  }
  // One byte more, so that zlib comes to the checksum behind the last one wanted.
  char beyond = 0;
  int error = Z_OK;
  gzread(stream.get(), &beyond, 1);
  gzerror(stream.get(), &error);
  if (error != Z_OK && error != Z_STREAM_END) return truncated(done);
  return std::nullopt;
}

std::optional<Failure> check_inflates(const fs::path& file, std::uint64_t bytes) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> stream(gzopen(file.c_str(), "rb"), gzclose);
  std::vector<std::byte> scratch(std::size_t(1) << 18);
  for (std::uint64_t left = bytes; left > 0;) {
    const auto wanted = unsigned(std::min<std::uint64_t>(scratch.size(), left));
    const int got = stream ? gzread(stream.get(), scratch.data(), wanted) : 0;
    if (got <= 0)
      return failure_of(file, fmt::format("its data ends or is damaged {} bytes early", left),
                        "the file is truncated: copy it again");
    left -= std::uint64_t(got);
  }
  return std::nullopt;
}

}  // namespace goldthread
