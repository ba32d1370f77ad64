// SPDX-License-Identifier: Apache-2.0
#include "bench/synthetic/gyroid.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace goldthread::bench {
namespace {

constexpr float kMiddle = 128, kSwing = 100 / 1.5F;
/// The border fades over this share of the squared radius.
constexpr float kFade = 8;

inline float voxel(float sine_x, float cosine_x, float square_x, float sine_y, float cosine_y,
                   float sine_z, float cosine_z, float square_yz) {
  const float gyroid = sine_x * cosine_y + sine_y * cosine_z + sine_z * cosine_x;
  const float inside = std::clamp((1 - square_x - square_yz) * kFade, 0.0F, 1.0F);
  return inside * (kMiddle + kSwing * gyroid) + 0.5F;
}

}  // namespace

Gyroid::Axis Gyroid::axis_of(int count, double per_voxel) {
  Axis axis;
  for (int i = 0; i < count; ++i) {
    const double middle = i - 0.5 * (count - 1);
    const double share = count > 1 ? 2 * middle / (count - 1) : 0;
    axis.sine.push_back(float(std::sin(per_voxel * middle)));
    axis.cosine.push_back(float(std::cos(per_voxel * middle)));
    axis.square.push_back(float(share * share));
  }
  return axis;
}

Gyroid::Gyroid(glm::ivec3 size, double waves) : size_(size) {
  const int longest = std::max(size.x, std::max(size.y, size.z));
  const double per_voxel = 2 * glm::pi<double>() * waves / longest;
  x_ = axis_of(size.x, per_voxel);
  y_ = axis_of(size.y, per_voxel);
  z_ = axis_of(size.z, per_voxel);
}

std::uint8_t Gyroid::at(int x, int y, int z) const {
  const auto i = std::size_t(x), j = std::size_t(y), k = std::size_t(z);
  return std::uint8_t(voxel(x_.sine[i], x_.cosine[i], x_.square[i], y_.sine[j], y_.cosine[j],
                            z_.sine[k], z_.cosine[k], y_.square[j] + z_.square[k]));
}

void Gyroid::slice(int z, std::span<std::uint8_t> to) const {
  const auto k = std::size_t(z);
  std::uint8_t* row = to.data();
  for (std::size_t j = 0; j < y_.sine.size(); ++j, row += size_.x)
    for (std::size_t i = 0; i < x_.sine.size(); ++i)
      row[i] = std::uint8_t(voxel(x_.sine[i], x_.cosine[i], x_.square[i], y_.sine[j], y_.cosine[j],
                                  z_.sine[k], z_.cosine[k], y_.square[j] + z_.square[k]));
}

}  // namespace goldthread::bench
