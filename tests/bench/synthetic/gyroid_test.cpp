// SPDX-License-Identifier: Apache-2.0
#include "bench/synthetic/gyroid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <vector>

namespace goldthread::bench {
namespace {

TEST(Gyroid, ASliceHoldsTheVoxelsOfTheFormula) {
  const Gyroid gyroid({20, 31, 17}, 2);
  std::vector<std::uint8_t> slice(20 * 31);
  const double per_voxel = 2 * glm::pi<double>() * 2 / 31;
  int seen = 0;
  for (int z = 0; z < 17; ++z) {
    gyroid.slice(z, slice);
    for (int y = 0; y < 31; ++y)
      for (int x = 0; x < 20; ++x) {
        EXPECT_EQ(slice[std::size_t(y * 20 + x)], gyroid.at(x, y, z));
        const glm::dvec3 middle = glm::dvec3(x, y, z) - 0.5 * glm::dvec3(19, 30, 16);
        const glm::dvec3 share = middle / (0.5 * glm::dvec3(19, 30, 16));
        const glm::dvec3 p = per_voxel * middle;
        const double g = std::sin(p.x) * std::cos(p.y) + std::sin(p.y) * std::cos(p.z) +
                         std::sin(p.z) * std::cos(p.x);
        const double inside = std::clamp(8 * (1 - glm::dot(share, share)), 0.0, 1.0);
        EXPECT_NEAR(gyroid.at(x, y, z), inside * (128 + 100 * g / 1.5), 0.51);
        seen += inside > 0 ? 1 : 0;
      }
  }
  EXPECT_GT(seen, 3000);
}

TEST(Gyroid, AVolumeOfOneVoxelIsItsMiddle) { EXPECT_EQ(Gyroid({1, 1, 1}, 3).at(0, 0, 0), 128); }

}  // namespace
}  // namespace goldthread::bench
