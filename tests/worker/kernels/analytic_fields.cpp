// SPDX-License-Identifier: Apache-2.0
#include "analytic_fields.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/scene/camera.h"

namespace goldthread::test {

std::shared_ptr<const Volume> sampled_cube(double edge_mm, int n, const WorldFunction& function) {
  const double spacing = edge_mm / (n - 1);
  const VolumeGeometry geometry{.size = {n, n, n}, .spacing_mm = glm::dvec3(spacing)};
  return make_volume(geometry, VoxelType::kFloat32,
                     [&](int i, int j, int k) { return function(glm::dvec3(i, j, k) * spacing); });
}

std::shared_ptr<const Volume> ramp_along_z(double edge_mm, int n) {
  const VolumeGeometry geometry{.size = {9, 9, n}, .spacing_mm = {4, 4, edge_mm / (n - 1)}};
  return make_volume(geometry, VoxelType::kFloat32,
                     [&](int, int, int k) { return double(k) / (n - 1); });
}

TransferFunction linear_extinction(const std::vector<ExtinctionNode>& nodes) {
  double greatest = 0;
  for (const ExtinctionNode& node : nodes) greatest = std::max(greatest, node.extinction);
  TransferFunction function{.unit_distance_mm = 1e-7 / greatest,
                            .color = {{nodes.front().value, {1, 1, 1}}},
                            .opacity = {}};
  for (const ExtinctionNode& node : nodes)
    function.opacity.push_back(
        {node.value, -std::expm1(-node.extinction * function.unit_distance_mm)});
  return function;
}

TransferFunction proportional_extinction(double scale, double greatest) {
  return linear_extinction({{0, 0}, {greatest, scale * greatest}});
}

TransferFunction sampled_extinction(const std::function<double(double)>& function) {
  std::vector<ExtinctionNode> nodes;
  for (int i = 0; i <= 2048; ++i) nodes.push_back({i / 2048.0, function(i / 2048.0)});
  return linear_extinction(nodes);
}

WorldRay world_ray(const Scene& scene, double edge_mm, PixelPosition position) {
  const Ray ray = camera_ray(*scene.camera, scene.image.size, position.x, position.y);
  WorldRay result{ray.origin, ray.direction, 0, std::numeric_limits<double>::infinity()};
  for (int a = 0; a < 3; ++a) {
    const double low = -ray.origin[a] / ray.direction[a];
    const double high = (edge_mm - ray.origin[a]) / ray.direction[a];
    result.entry_mm = std::max(result.entry_mm, std::min(low, high));
    result.exit_mm = std::min(result.exit_mm, std::max(low, high));
  }
  return result;
}

Scene axial_scene(const VolumeGeometry& geometry, TransferFunction function) {
  const glm::dvec3 extent = glm::dvec3(geometry.size - 1) * geometry.spacing_mm;
  Scene scene;
  scene.image.size = {8, 8};
  const glm::dvec3 target(0.5 * extent.x + 0.013, 0.5 * extent.y + 0.021, 0);
  scene.camera = Camera{target - glm::dvec3(0, 0, 37.3), target, {0, 1, 0}, 1};
  SceneVolume volume;
  volume.transfer_function = std::move(function);
  scene.volumes = {volume};
  return scene;
}

Sample central_ray(const Scene& scene, const std::shared_ptr<const Volume>& volume) {
  return cast(scene, volume, {{4, 4}}).front();
}

Scene oblique_scene(double edge_mm, TransferFunction function) {
  Scene scene;
  scene.image.size = {64, 64};
  const glm::dvec3 centre(0.5 * edge_mm);
  scene.camera = Camera{centre + glm::dvec3(-1.7, -2.3, 1.1) * edge_mm, centre, {0, 0, 1}, 12};
  SceneVolume volume;
  volume.transfer_function = std::move(function);
  scene.volumes = {volume};
  return scene;
}

std::vector<PixelPosition> fan(const Scene& scene, int per_edge) {
  std::vector<PixelPosition> rays;
  const float step_x = float(scene.image.size.width) / float(per_edge);
  const float step_y = float(scene.image.size.height) / float(per_edge);
  for (int j = 0; j < per_edge; ++j)
    for (int i = 0; i < per_edge; ++i)
      rays.push_back({(float(i) + 0.5F) * step_x, (float(j) + 0.5F) * step_y});
  return rays;
}

double rms_opacity_error(const Scene& scene, const std::shared_ptr<const Volume>& volume,
                         const std::vector<PixelPosition>& rays,
                         const std::function<double(PixelPosition)>& expected) {
  const Picture picture = cast(scene, volume, rays);
  double sum = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double off = picture[i].alpha - expected(rays[i]);
    sum += off * off;
  }
  return std::sqrt(sum / double(rays.size()));
}

}  // namespace goldthread::test
