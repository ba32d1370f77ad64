// SPDX-License-Identifier: Apache-2.0
#include "random_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace goldthread::test {
namespace {

constexpr int kRays = 6;

class Generator {
 public:
  explicit Generator(unsigned number) : engine_(number * 2654435761U + 17) {}

  RandomCase make();

 private:
  double real(double low, double high) {
    // Not the standard's distribution: the same numbers from every library.
    return low + (high - low) * (double(engine_()) / 4294967296.0);
  }
  int integer(int low, int high) { return low + int(engine_() % unsigned(high - low + 1)); }
  bool chance(double share) { return real(0, 1) < share; }
  double log_real(double low, double high) { return std::exp(real(std::log(low), std::log(high))); }
  glm::dvec3 direction() {
    while (true) {
      const double x = real(-1, 1), y = real(-1, 1), z = real(-1, 1);
      const glm::dvec3 v(x, y, z);
      if (glm::length(v) > 0.1 && glm::length(v) < 1) return glm::normalize(v);
    }
  }
  glm::dvec3 color() {
    const double r = real(0, 1), g = real(0, 1), b = real(0, 1);
    return {r, g, b};
  }

  VolumeGeometry geometry();
  FieldFunction field();
  std::shared_ptr<const Volume> volume();
  TransferFunction transfer_function(const VolumeInfo& info, double diagonal);
  std::vector<Light> lights(const glm::dvec3& centre, double diagonal);
  Camera camera(const VolumeGeometry& geometry);

  std::mt19937 engine_;
};

VolumeGeometry Generator::geometry() {
  VolumeGeometry geometry;
  geometry.size = {integer(2, 20), integer(2, 20), integer(2, 20)};
  const double stretch = chance(0.1) ? 50 : 3;
  for (int a = 0; a < 3; ++a) geometry.spacing_mm[a] = log_real(1 / stretch, stretch);
  const double far = chance(0.1) ? 1e6 : 100;
  geometry.origin_mm = direction() * real(0, far);
  const int kind = integer(0, 2);
  if (kind == 0) return geometry;
  const glm::dvec3 x = direction();
  const glm::dvec3 y = glm::normalize(glm::cross(x, direction()));
  geometry.direction = glm::dmat3(x, y, glm::cross(x, y));
  if (kind == 2) {
    const double shear = real(-0.8, 0.8);
    geometry.direction[1] = glm::normalize(y + shear * x);
  }
  return geometry;
}

// Values from 0 to 1.
FieldFunction Generator::field() {
  const double a = real(0.1, 2), b = real(0.1, 2), c = real(0.1, 2), d = real(0, 6);
  switch (integer(0, 3)) {
    case 0:  // waves
      return [=](int i, int j, int k) {
        return 0.5 + 0.5 * std::sin(a * i + d) * std::cos(b * j) * std::sin(c * k + 2);
      };
    case 1:  // noise, every voxel by itself
      return [this](int, int, int) { return real(0, 1); };
    case 2:  // a slope
      return [=](int i, int j, int k) { return (a * i + b * j + c * k) / 120; };
    default:  // plateaus
      return [=](int i, int j, int k) {
        return std::sin(a * i + b * j + d) + std::cos(c * k) > 0.3 ? 0.9 : 0.1;
      };
  }
}

std::shared_ptr<const Volume> Generator::volume() {
  const VolumeGeometry shape = geometry();
  const auto type = VoxelType(integer(0, 4));
  double low = 0, high = 1;
  if (type == VoxelType::kUInt8) high = 255;
  if (type == VoxelType::kInt8) low = -128, high = 127;
  if (type == VoxelType::kUInt16) high = chance(0.5) ? 65535 : 4095;
  if (type == VoxelType::kInt16) low = -1024, high = 3071;
  if (type == VoxelType::kFloat32) low = real(-5, 5), high = low + log_real(1e-2, 1e4);
  const bool some_bad = type == VoxelType::kFloat32 && chance(0.2);
  const FieldFunction unit = field();
  return make_volume(shape, type, [&](int i, int j, int k) {
    const double value = low + (high - low) * unit(i, j, k);
    if (some_bad && chance(0.02))
      return chance(0.5) ? std::numeric_limits<double>::quiet_NaN()
                         : std::numeric_limits<double>::infinity();
    return value;
  });
}

TransferFunction Generator::transfer_function(const VolumeInfo& info, double diagonal) {
  TransferFunction function{
      .unit_distance_mm = diagonal * log_real(0.02, 1), .color = {}, .opacity = {}};
  const double range = std::max(info.maximum - info.minimum, 1e-3);
  const auto value = [&](double share) { return info.minimum + range * share; };
  for (int i = 0, count = integer(1, 5); i < count; ++i)
    function.color.push_back({value((i + real(0, 1)) / count), color()});
  const double height = chance(0.1) ? 1 : real(0.1, 0.95);
  const int kind = integer(0, 2);
  for (int i = 0, count = integer(2, 4); i < count; ++i) {
    const double at = value((i + real(0.1, 0.9)) / count);
    if (kind == 0) {  // slopes
      function.opacity.push_back({at, chance(0.3) ? 0 : real(0, height)});
    } else if (kind == 1) {  // steps
      const double before = function.opacity.empty() ? 0 : function.opacity.back().alpha;
      function.opacity.push_back({at, before});
      function.opacity.push_back({at, chance(0.4) ? 0 : real(0, height)});
    } else {  // peaks
      const double width = range * real(0.005, 0.05) / count;
      function.opacity.push_back({at - width, 0});
      function.opacity.push_back({at, real(0, height)});
      function.opacity.push_back({at + width, 0});
    }
  }
  return function;
}

std::vector<Light> Generator::lights(const glm::dvec3& centre, double diagonal) {
  std::vector<Light> lights;
  for (int i = 0, count = integer(1, 3); i < count; ++i) {
    Light light{Headlight{}, real(0.2, 1), color()};
    if (chance(0.3)) light.kind = DirectionalLight{direction() * real(0.1, 10)};
    if (chance(0.3)) light.kind = PointLight{centre + direction() * diagonal * real(0.1, 3)};
    lights.push_back(light);
  }
  return lights;
}

Camera Generator::camera(const VolumeGeometry& geometry) {
  const glm::dmat4 map = geometry.world_from_index();
  const auto world = [&](const glm::dvec3& index) {
    return glm::dvec3(map * glm::dvec4(index, 1));
  };
  const glm::dvec3 last(geometry.size - 1);
  const double x = real(0, 1), y = real(0, 1), z = real(0, 1);
  glm::dvec3 inside = last * glm::dvec3(x, y, z);
  const glm::dvec3 centre = world(0.5 * last);
  const double radius = 0.5 * glm::length(world(last) - world({0, 0, 0}));
  Camera camera;
  camera.target = world(last * glm::dvec3{real(0.2, 0.8), real(0.2, 0.8), real(0.2, 0.8)});
  camera.up = direction();
  camera.fovy_deg = 25;
  const int axis = integer(0, 2);
  switch (integer(0, 5)) {
    case 0:  // inside
      camera.position = world(inside);
      camera.fovy_deg = 80;
      break;
    case 1:  // on a face
      inside[axis] = chance(0.5) ? 0 : last[axis];
      camera.position = world(inside);
      camera.fovy_deg = 80;
      break;
    case 2:  // on a voxel
      camera.position = world(glm::floor(inside));
      camera.fovy_deg = 80;
      break;
    case 3:  // looking along an axis of the grid
      camera.position =
          camera.target + geometry.direction[axis] * (chance(0.5) ? 3.0 : -3.0) * radius;
      break;
    case 4:  // far away
      camera.position = centre + direction() * radius * 1e4;
      camera.fovy_deg = glm::degrees(2 * std::atan(0.8e-4));
      break;
    default:
      camera.position = centre + direction() * radius * real(1.5, 4);
  }
  if (glm::length(camera.target - camera.position) < 1e-3 * radius)
    camera.target = camera.position + direction() * radius;
  return camera;
}

RandomCase Generator::make() {
  RandomCase result;
  result.volume = volume();
  const VolumeInfo& info = result.volume->info();
  const glm::dmat4 map = info.geometry.world_from_index();
  const glm::dvec3 extent(map * glm::dvec4(glm::dvec3(info.geometry.size - 1), 0));
  double diagonal = 0;
  for (int a = 0; a < 3; ++a) diagonal += info.geometry.spacing_mm[a] * (info.geometry.size[a] - 1);
  Scene& scene = result.scene;
  scene.image.size = {16, 16};
  scene.camera = camera(info.geometry);
  scene.lights = lights(glm::dvec3(map[3]) + 0.5 * extent, diagonal);
  SceneVolume material;
  material.transfer_function = transfer_function(info, diagonal);
  const double mode = real(0, 1);
  material.mode = mode < 0.65 ? Mode::kDvr : (mode < 0.8 ? Mode::kIsosurface : Mode::kMip);
  if (chance(0.4))
    material.shading =
        Shading{real(0, 0.5), real(0, 0.8), real(0, 0.5), chance(0.5) ? 20 : real(1, 50)};
  // Never just the value of a constant volume, of which each rounding would make a surface.
  const double range = std::max(info.maximum - info.minimum, 1e-3);
  if (material.mode == Mode::kIsosurface || (material.mode == Mode::kDvr && chance(0.15)))
    for (int i = 0, count = integer(1, 3); i < count; ++i)
      material.isosurfaces.push_back(
          {info.minimum + real(0, 1) * range, color(), chance(0.4) ? 1 : real(0, 1)});
  scene.volumes = {material};
  const glm::dvec3& spacing = info.geometry.spacing_mm;
  const double smallest = std::min({spacing.x, spacing.y, spacing.z});
  scene.step_mm = std::max(log_real(0.05, 1) * smallest, diagonal / 400);
  result.rays.push_back({8, 8});
  for (int i = 1; i < kRays; ++i) result.rays.push_back({float(real(0, 16)), float(real(0, 16))});
  return result;
}

}  // namespace

RandomCase random_case(unsigned number) { return Generator(number).make(); }

}  // namespace goldthread::test
