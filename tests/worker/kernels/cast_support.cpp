// SPDX-License-Identifier: Apache-2.0
#include "cast_support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <glm/gtc/constants.hpp>

#include "common/scene/camera.h"
#include "common/volume/build_volume.h"
#include "common/volume/volume_io.h"

namespace goldthread::test {
namespace {

template <class T>
void append(std::vector<std::byte>& bytes, T value) {
  const auto* from = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), from, from + sizeof(T));
}

void append_as(VoxelType type, double value, std::vector<std::byte>& bytes) {
  switch (type) {
    case VoxelType::kUInt8:
      return append(bytes, std::uint8_t(std::lround(value)));
    case VoxelType::kInt8:
      return append(bytes, std::int8_t(std::lround(value)));
    case VoxelType::kUInt16:
      return append(bytes, std::uint16_t(std::lround(value)));
    case VoxelType::kInt16:
      return append(bytes, std::int16_t(std::lround(value)));
    case VoxelType::kFloat32:
      return append(bytes, float(value));
  }
}

}  // namespace

std::shared_ptr<const Volume> make_volume(const VolumeGeometry& geometry, VoxelType type,
                                          const FieldFunction& field) {
  std::vector<std::byte> voxels;
  for (int k = 0; k < geometry.size.z; ++k)
    for (int j = 0; j < geometry.size.y; ++j)
      for (int i = 0; i < geometry.size.x; ++i) append_as(type, field(i, j, k), voxels);
  VolumeInfo info;
  info.geometry = geometry;
  info.type = type;
  return build_volume(info, voxels);
}

std::shared_ptr<const Volume> load_head() {
  const std::filesystem::path path = "/usr/share/mricron/templates/ch2.nii.gz";
  if (!std::filesystem::exists(path)) return nullptr;
  const LoadedVolume loaded = value_or_throw(load_volume(path));
  return build_volume(loaded.info, loaded.voxels());
}

Scene head_scene(const VolumeInfo& info) {
  Scene scene;
  scene.image.size = {512, 512};
  scene.camera = framing_camera(info.geometry, 36, 0);
  SceneVolume volume;
  TransferFunction function;
  function.color = {
      {0, {0, 0, 0}}, {60, {0.8, 0.4, 0.3}}, {120, {0.95, 0.9, 0.8}}, {255, {1, 1, 1}}};
  function.opacity = {{0, 0}, {30, 0}, {60, 0.02}, {120, 0.15}, {255, 0.4}};
  volume.transfer_function = function;
  scene.volumes = {volume};
  return scene;
}

Camera framing_camera(const VolumeGeometry& geometry, double azimuth_deg, double elevation_deg) {
  const glm::dmat4 map = geometry.world_from_index();
  const glm::dvec3 last = glm::dvec3(geometry.size - 1);
  const glm::dvec3 centre(map * glm::dvec4(0.5 * last, 1));
  const double radius =
      0.5 * glm::length(glm::dvec3(map * glm::dvec4(last, 1)) - glm::dvec3(map[3]));
  const double azimuth = glm::radians(azimuth_deg), elevation = glm::radians(elevation_deg);
  Camera camera;
  camera.target = centre;
  camera.fovy_deg = 30;
  const glm::dvec3 away(std::sin(azimuth) * std::cos(elevation),
                        -std::cos(azimuth) * std::cos(elevation), std::sin(elevation));
  camera.position = centre + away * (radius / std::sin(glm::radians(15.0)));
  camera.up = {0, 0, 1};
  return camera;
}

Scene ramp_scene(const VolumeInfo& info) {
  Scene scene;
  scene.image.size = {32, 32};
  scene.camera = framing_camera(info.geometry, 25, 20);
  TransferFunction function;
  function.color = {{info.minimum, {1, 0.2, 0.1}}, {info.maximum, {0.3, 0.9, 1}}};
  function.opacity = {{info.minimum, 0}, {info.maximum, 0.5}};
  SceneVolume volume;
  volume.transfer_function = function;
  scene.volumes = {volume};
  return scene;
}

std::vector<PixelPosition> pixel_centres(ImageSize size, int stride) {
  std::vector<PixelPosition> positions;
  for (int y = 0; y < size.height; y += stride)
    for (int x = 0; x < size.width; x += stride)
      positions.push_back({float(x) + 0.5F, float(y) + 0.5F});
  return positions;
}

Picture cast(const SampleSource& source, const std::vector<PixelPosition>& positions) {
  Picture picture(positions.size());
  source.cast(positions, picture);
  if (!is_sane(picture)) ADD_FAILURE() << "a sample is NaN, infinite, negative or above 1 in alpha";
  return picture;
}

Picture cast(const Scene& scene, std::shared_ptr<const Volume> volume,
             const std::vector<PixelPosition>& positions) {
  return cast(
      *make_ray_caster(commit_scene(scene, std::move(volume)), *scene.camera, scene.image.size),
      positions);
}

Picture reference_picture(const Scene& scene, const Volume& volume,
                          const std::vector<PixelPosition>& positions, int substeps) {
  const reference::Integrator integrator(scene, volume.info().geometry,
                                         reference::voxels_of(volume), substeps);
  Picture picture;
  for (const PixelPosition& p : positions) {
    const auto radiance = integrator.cast(p.x, p.y);
    picture.push_back({float(radiance.color.r), float(radiance.color.g), float(radiance.color.b),
                       float(radiance.alpha)});
  }
  return picture;
}

Distance distance(const Picture& a, const Picture& b) {
  Distance result;
  double sum = 0;
  std::size_t above = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double channels[4] = {a[i].red - b[i].red, a[i].green - b[i].green, a[i].blue - b[i].blue,
                                a[i].alpha - b[i].alpha};
    double pixel = 0;
    for (const double c : channels) {
      const double off = std::abs(c) * 255;
      sum += off * off;
      pixel = std::isnan(off) ? INFINITY : std::max(pixel, off);
    }
    result.greatest = std::max(result.greatest, pixel);
    above += pixel > 32;
  }
  const double count = double(std::max<std::size_t>(a.size(), 1));
  result.rms = std::sqrt(sum / (4 * count));
  result.share_above_32 = double(above) / count;
  return result;
}

bool same_bits(const Picture& a, const Picture& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Sample)) == 0;
}

bool is_sane(const Picture& picture) {
  return std::all_of(picture.begin(), picture.end(), [](const Sample& s) {
    const auto fine = [](float v) { return std::isfinite(v) && !(v < 0); };
    return fine(s.red) && fine(s.green) && fine(s.blue) && fine(s.alpha) && s.alpha <= 1;
  });
}

}  // namespace goldthread::test
