// SPDX-License-Identifier: Apache-2.0
#include "bench/error/subject.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "common/scene/resolve.h"
#include "common/volume/build_volume.h"
#include "common/volume/volume_io.h"

namespace goldthread::bench {
namespace {

constexpr const char* kHead = "/usr/share/mricron/templates/ch2.nii.gz";
constexpr double kPreferredIsovalue = 80;

Camera head_camera(const VolumeGeometry& geometry) {
  const glm::dmat4 map = geometry.world_from_index();
  const glm::dvec3 low(map[3]), high(map * glm::dvec4(glm::dvec3(geometry.size - 1), 1));
  const double azimuth = glm::radians(36.0);
  Camera camera;
  camera.fovy_deg = 30;
  const double away = 0.5 * glm::length(high - low) / std::sin(glm::radians(15.0));
  camera.target = 0.5 * (low + high);
  camera.position = camera.target + away * glm::dvec3(std::sin(azimuth), -std::cos(azimuth), 0);
  camera.up = {0, 0, 1};
  return camera;
}

double isovalue_of(const Scene& scene, const VolumeInfo& info) {
  const auto& surfaces = scene.volumes.front().isosurfaces;
  if (!surfaces.empty()) return surfaces.front().value;
  if (kPreferredIsovalue > info.minimum && kPreferredIsovalue + 1 < info.maximum)
    return kPreferredIsovalue;
  return foreground_threshold(info);
}

/// Every data value as value · scale + offset, the transfer function and isovalues with it.
Scene rescaled(Scene scene, double scale, double offset) {
  SceneVolume& volume = scene.volumes.front();
  for (ColorNode& node : volume.transfer_function->color) node.value = node.value * scale + offset;
  for (OpacityNode& node : volume.transfer_function->opacity)
    node.value = node.value * scale + offset;
  return scene;
}

template <class T>
std::shared_ptr<const Volume> volume_of(const VolumeInfo& like, VoxelType type,
                                        const std::vector<std::uint8_t>& levels, int factor) {
  VolumeInfo info = like;
  info.type = type;
  std::vector<T> voxels(levels.size());
  std::transform(levels.begin(), levels.end(), voxels.begin(),
                 [&](std::uint8_t level) { return static_cast<T>(level * factor); });
  return build_volume(info, std::as_bytes(std::span(voxels)));
}

/// 256 levels over the data's range, x fastest; uint8 as it is.
std::vector<std::uint8_t> levels_of(const Volume& volume, double scale, double offset) {
  const glm::ivec3 size = volume.info().geometry.size;
  std::vector<std::uint8_t> levels;
  levels.reserve(volume.info().geometry.voxel_count());
  for (int k = 0; k < size.z; ++k)
    for (int j = 0; j < size.y; ++j)
      for (int i = 0; i < size.x; ++i) {
        const double level = volume.at(i, j, k) * scale + offset;
        levels.push_back(level > 0 ? static_cast<std::uint8_t>(std::lround(std::min(level, 255.0)))
                                   : 0);
      }
  return levels;
}

std::vector<Light> three_lights() {
  return {Light{}, Light{DirectionalLight{{1, 1, -1}}, 0.5, {1, 0.9, 0.8}},
          Light{DirectionalLight{{-1, 1, 0}}, 0.5, {0.8, 0.9, 1}}};
}

std::vector<Isosurface> translucent_surfaces(const Subject& subject) {
  const VolumeInfo& info = subject.volume->info();
  std::vector<Isosurface> surfaces;
  for (int i = 0; i < 4; ++i) {
    const double value = subject.isovalue + i * (info.maximum - subject.isovalue) / 5;
    surfaces.push_back({value, {0.9, 0.8, 0.7}, 0.3});
  }
  return surfaces;
}

}  // namespace

const char* name_of(Look look) {
  switch (look) {
    case Look::kUnlit:
      return "unlit";
    case Look::kPhong:
      return "Phong";
    case Look::kMip:
      return "mip";
    case Look::kIsosurface:
      return "isosurface";
  }
  return "";
}

Scene Subject::in(Look look, double step_mm) const {
  Scene variant = scene;
  variant.step_mm = step_mm;
  SceneVolume& look_of = variant.volumes.front();
  const Shading shading = look_of.shading.value_or(Shading{});
  look_of.shading.reset();
  look_of.isosurfaces.clear();
  look_of.mode = look == Look::kMip ? Mode::kMip : Mode::kDvr;
  if (look == Look::kPhong || look == Look::kIsosurface) look_of.shading = shading;
  if (look == Look::kIsosurface) {
    look_of.mode = Mode::kIsosurface;
    look_of.isosurfaces = {{isovalue, {0.9, 0.8, 0.7}, 1}};
  }
  return variant;
}

Scene Subject::with_isovalue(double value) const {
  Scene variant = in(Look::kIsosurface);
  variant.volumes.front().isosurfaces.front().value = value;
  return variant;
}

Scene default_scene() {
  SceneVolume volume;
  volume.name = "head";
  volume.file = kHead;
  volume.transfer_function.emplace();
  volume.transfer_function->color = {
      {0, {0, 0, 0}}, {60, {0.8, 0.4, 0.3}}, {120, {0.95, 0.9, 0.8}}, {255, {1, 1, 1}}};
  volume.transfer_function->opacity = {{0, 0}, {30, 0}, {60, 0.02}, {120, 0.15}, {255, 0.4}};
  Scene scene;
  scene.image.size = {512, 512};
  scene.volumes = {volume};
  return scene;
}

Result<Subject> load_subject(Scene scene, bool is_default) {
  const SceneVolume& entry = scene.volumes.front();
  LoadOptions load;
  load.component = entry.component;
  auto loaded = load_volume(entry.file, load);
  if (!loaded) {
    Failure failure = loaded.failure();
    if (is_default) failure.mend = "install Debian's mricron-data, or name a scene";
    return failure;
  }
  Subject subject;
  subject.is_default = is_default;
  subject.volume = build_volume(std::move(loaded->info), loaded->voxels());
  const VolumeInfo& info = subject.volume->info();
  if (glm::any(glm::lessThan(info.geometry.size, glm::ivec3(2))))
    return Failure{info.file, "is only one voxel thick", "choose a volume with an extent"};
  if (is_default) scene.camera = head_camera(info.geometry);
  subject.scene = resolve_scene(scene, info);
  subject.scene.lights = {Light{}};
  const glm::dvec3 spacing = glm::abs(info.geometry.spacing_mm);
  subject.voxel_mm = std::min({spacing.x, spacing.y, spacing.z});
  subject.isovalue = isovalue_of(subject.scene, info);
  const bool floats = info.type == VoxelType::kFloat32;
  subject.next_isovalue = subject.isovalue + (floats ? (info.maximum - info.minimum) / 255 : 1);
  return subject;
}

std::vector<Stored> stored_variants(const Subject& subject) {
  const VolumeInfo& info = subject.volume->info();
  const bool whole = info.type == VoxelType::kUInt8;
  const double range = std::max(info.maximum - info.minimum, 1e-30);
  const double scale = whole ? 1 : 255 / range;
  const double offset = whole ? 0 : -info.minimum * scale;
  const auto levels = levels_of(*subject.volume, scale, offset);
  const Scene scene = rescaled(subject.in(Look::kUnlit), scale, offset);
  return {{"uint8", scene, volume_of<std::uint8_t>(info, VoxelType::kUInt8, levels, 1)},
          {"uint16", rescaled(scene, 257, 0),
           volume_of<std::uint16_t>(info, VoxelType::kUInt16, levels, 257)},
          {"float32", scene, volume_of<float>(info, VoxelType::kFloat32, levels, 1)}};
}

std::vector<FeatureCase> feature_cases(const Subject& subject) {
  const Scene unlit = subject.in(Look::kUnlit), phong = subject.in(Look::kPhong);
  const Scene mip = subject.in(Look::kMip), surface = subject.in(Look::kIsosurface);
  const auto with = [](Scene scene, const auto& change) {
    change(scene, scene.volumes.front());
    return scene;
  };
  const Camera camera = *subject.scene.camera;
  const glm::dvec3 beside = camera.position + 0.5 * glm::length(camera.position - camera.target) *
                                                  glm::normalize(camera.up);
  std::vector<FeatureCase> cases;
  cases.push_back({"dvr, unlit", "", unlit});
  cases.push_back({"dvr, headlight", "", phong});
  cases.push_back({"mip", "", mip});
  cases.push_back({"opaque isosurface, headlight", "", surface});
  cases.push_back({"+ Phong shading, headlight", "dvr, unlit", phong});
  cases.push_back(
      {"+ point light instead of headlight", "dvr, headlight",
       with(phong, [&](Scene& s, SceneVolume&) { s.lights = {Light{PointLight{beside}}}; })});
  cases.push_back({"+ two further lights", "dvr, headlight",
                   with(phong, [](Scene& s, SceneVolume&) { s.lights = three_lights(); })});
  cases.push_back(
      {"+ one translucent isosurface", "dvr, unlit", with(unlit, [&](Scene&, SceneVolume& v) {
         v.isosurfaces = {{subject.isovalue, {0.9, 0.8, 0.7}, 0.3}};
       })});
  cases.push_back(
      {"+ four translucent isosurfaces", "dvr, unlit", with(unlit, [&](Scene&, SceneVolume& v) {
         v.isosurfaces = translucent_surfaces(subject);
       })});
  cases.push_back({"greatest value instead of dvr", "dvr, unlit", mip});
  cases.push_back({"opaque isosurface instead of dvr", "dvr, headlight", surface});
  cases.push_back({"off: nothing at all (the same scene twice)", "dvr, unlit", unlit, true});
  cases.push_back({"off: three lights without shading", "dvr, unlit",
                   with(unlit, [](Scene& s, SceneVolume&) { s.lights = three_lights(); }), true});
  cases.push_back({"off: shading without a light that shines", "dvr, unlit",
                   with(unlit,
                        [](Scene& s, SceneVolume& v) {
                          v.shading = Shading{1, 0.7, 0.2, 20};
                          s.lights.front().intensity = 0;
                        }),
                   true});
  cases.push_back({"off: isosurfaces and shading beside mip", "mip",
                   with(mip,
                        [&](Scene&, SceneVolume& v) {
                          v.shading = Shading{};
                          v.isosurfaces = translucent_surfaces(subject);
                        }),
                   true});
  return cases;
}

}  // namespace goldthread::bench
