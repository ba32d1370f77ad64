// SPDX-License-Identifier: Apache-2.0
#pragma once
// A soft ball of 24³ voxels in a raw file of the test's own folder, and the subject made of it.

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "bench/error/subject.h"
#include "common/scene/scene_file.h"

namespace goldthread::bench::test {

inline std::filesystem::path write_ball(const std::filesystem::path& folder) {
  constexpr int kEdge = 24;
  std::filesystem::create_directories(folder);
  const auto file = folder / "ball_24x24x24_uint8.raw";
  std::vector<char> bytes;
  for (int k = 0; k < kEdge; ++k)
    for (int j = 0; j < kEdge; ++j)
      for (int i = 0; i < kEdge; ++i) {
        const double c = 0.5 * (kEdge - 1);
        const double r = std::hypot(i - c, j - c, k - c) / c;
        const double value = std::round(std::max(0.0, 255 * (1 - r)));
        bytes.push_back(static_cast<char>(static_cast<std::uint8_t>(value)));
      }
  std::ofstream(file, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
  return file;
}

/// 32×32 pixels.
inline Subject ball_subject(const std::string& folder_name) {
  const auto file = write_ball(std::filesystem::path(testing::TempDir()) / folder_name);
  Scene scene = value_or_throw(read_scene(file));
  scene.image.size = {32, 32};
  return value_or_throw(load_subject(scene, false));
}

}  // namespace goldthread::bench::test
