// SPDX-License-Identifier: Apache-2.0
// goldthread-synthetic FILE: writes a raw volume of the size in its name, name_XxYxZ_uint8.raw.

#include <array>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/synthetic/gyroid.h"
#include "common/base/result.h"

namespace goldthread {
namespace {

constexpr double kWaves = 12;
constexpr int kMostEdge = 1 << 16;

Failure usage(const std::string& where, const std::string& what) {
  return {where, what, "name it like gyroid_512x512x512_uint8.raw", ExitStatus::kUsage};
}

/// The three numbers of "…_XxYxZ_uint8".
std::optional<glm::ivec3> size_in(const std::string& stem) {
  constexpr std::string_view kEnd = "_uint8";
  if (!stem.ends_with(kEnd)) return {};
  const std::string_view name = std::string_view(stem).substr(0, stem.size() - kEnd.size());
  const char* at = name.data() + name.rfind('_') + 1;
  const char* end = name.data() + name.size();
  glm::ivec3 size{0};
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0 && (at == end || *at++ != 'x')) return {};
    const auto [next, error] = std::from_chars(at, end, size[axis]);
    if (error != std::errc() || size[axis] < 1 || size[axis] > kMostEdge) return {};
    at = next;
  }
  return at == end ? std::optional(size) : std::nullopt;
}

void write(const std::filesystem::path& file, const bench::Gyroid& gyroid) {
  const std::filesystem::path part = file.string() + ".part";
  {
    std::ofstream stream(part, std::ios::binary);
    std::vector<std::uint8_t> slice(std::size_t(gyroid.size().x) * std::size_t(gyroid.size().y));
    for (int z = 0; z < gyroid.size().z; ++z) {
      gyroid.slice(z, slice);
      stream.write(reinterpret_cast<const char*>(slice.data()), std::streamsize(slice.size()));
    }
    stream.close();
    if (!stream) {
      std::error_code ignored;
      std::filesystem::remove(part, ignored);
      throw FatalError({file.string(), "cannot be written", "make room, or choose another place",
                        ExitStatus::kClusterFailed});
    }
  }
  std::filesystem::rename(part, file);
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.size() != 1 || arguments[0].starts_with("-"))
    throw FatalError(usage("command line", "takes one FILE"));
  const std::filesystem::path file = arguments[0];
  const auto size = size_in(file.stem().string());
  if (!size || file.extension() != ".raw")
    throw FatalError(usage(file.string(), "does not tell a size"));
  write(file, bench::Gyroid(*size, kWaves));
  return 0;
}

}  // namespace
}  // namespace goldthread

int main(int argc, char** argv) {
  try {
    return goldthread::run({argv + 1, argv + argc});
  } catch (const goldthread::FatalError& error) {
    std::fprintf(stderr, "%s\n", error.failure().line().c_str());
    return static_cast<int>(error.failure().status);
  }
}
