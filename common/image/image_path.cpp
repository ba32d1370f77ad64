// SPDX-License-Identifier: Apache-2.0
// Split from image_file.cpp: what a path's extension says needs no image library.
#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "common/base/text.h"
#include "common/image/image_file.h"

namespace goldthread {
namespace {

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

}  // namespace

bool is_float_image(const std::filesystem::path& path) { return extension_of(path) == ".exr"; }

bool can_be_float_image(const std::filesystem::path& path) {
  return is_float_image(path) || extension_of(path).starts_with(".tif");
}

Result<std::filesystem::path> image_path(const std::string& path) {
  constexpr std::array<std::string_view, 6> kKnown = {".png",  ".exr", ".tif",
                                                      ".tiff", ".jpg", ".jpeg"};
  const std::string extension = extension_of(path);
  if (std::find(kKnown.begin(), kKnown.end(), extension) != kKnown.end()) {
    return std::filesystem::path(path);
  }
  return Failure{printable(path, 400),
                 extension.empty()
                     ? "has no extension that names an image format"
                     : "no image format is known for \"" + printable(extension) + "\"",
                 "write .png, .exr, .tif or .jpg", ExitStatus::kUsage};
}

}  // namespace goldthread
