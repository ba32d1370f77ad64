// SPDX-License-Identifier: Apache-2.0
#include "common/scene/text_file.h"

#include <fmt/format.h>

#include <fstream>

#include "common/base/text.h"

namespace goldthread {

Result<std::string> read_text_file(const std::filesystem::path& path, std::size_t limit) {
  const std::string where = printable(path.string(), 400);
  std::error_code error;
  // A pipe or a device could be read for ever.
  if (!std::filesystem::is_regular_file(path, error)) {
    const bool exists = std::filesystem::exists(path, error);
    return Failure{where, exists ? "is not a file" : "there is no such file", "check the path"};
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return Failure{where, "cannot be opened", "check its permissions"};
  std::string text(limit + 1, '\0');  // one byte more shows that it is too large
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad()) return Failure{where, "cannot be read", "check the disk"};
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() <= limit) return text;
  return Failure{where, fmt::format("larger than {} KB", limit >> 10), "is it the right file?"};
}

}  // namespace goldthread
