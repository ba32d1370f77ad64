// SPDX-License-Identifier: Apache-2.0
#include "surface_probe.h"

#include <algorithm>
#include <cmath>

namespace goldthread::test {

std::shared_ptr<const Volume> random_volume(int n, const Kind& kind, Random& random) {
  return make_volume({.size = {n, n, n}}, kind.type,
                     [&](int, int, int) { return kind.value(random(0, 1)); });
}

Scene count_scene(const Camera& camera, double isovalue) {
  Scene scene;
  scene.image.size = {64, 64};
  scene.camera = camera;
  SceneVolume volume;
  volume.mode = Mode::kIsosurface;
  volume.isosurfaces = {{isovalue, {1, 1, 1}, kSurfaceOpacity}};
  scene.volumes = {volume};
  return scene;
}

Scene depth_scene(const Camera& camera, double isovalue) {
  Scene scene = count_scene(camera, isovalue);
  SceneVolume& volume = scene.volumes[0];
  volume.mode = Mode::kDvr;
  volume.isosurfaces = {{isovalue, {0, 1, 0}, 1}};
  volume.transfer_function =
      TransferFunction{.color = {{0, {1, 0, 0}}}, .opacity = {{0, -std::expm1(-kExtinction)}}};
  return scene;
}

int hits_from(float alpha) {
  return int(std::lround(std::log1p(-double(alpha)) / std::log1p(-kSurfaceOpacity)));
}

double depth_mm_from(float red) {
  return -std::log1p(-std::min(double(red), 1 - 1e-9)) / kExtinction;
}

void compare_counts(const ExactField& field, const Scene& scene,
                    const std::vector<PixelPosition>& rays, const Picture& picture, Tally& tally) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const IndexRay ray = index_ray(scene, field.geometry(), rays[i]);
    const Crossings found = field.crossings(ray, scene.volumes[0].isosurfaces[0].value);
    tally.cells += long(field.spans(ray).size());
    ++tally.rays;
    const long expected = long(found.hits.size());
    if (found.clearance < kUndecidable) {
      ++tally.undecidable;
      continue;
    }
    tally.hits += expected;
    // Behind so many nothing can be seen.
    const long seen = hits_from(picture[i].alpha);
    if (expected >= 24 && seen >= 24) continue;
    tally.missed += std::max(0L, expected - seen);
    tally.false_hits += std::max(0L, seen - expected);
  }
}

void compare_depths(const ExactField& field, const Scene& scene,
                    const std::vector<PixelPosition>& rays, const Picture& picture,
                    const Kind& kind, double segments_per_mm, Tally& tally) {
  constexpr double kPlace = 1e-5;
  // Cells of random voxels span at least about a third of the range.
  const double unsure = 4e-7 + 3 * kind.rounding / (kind.high - kind.low);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const IndexRay ray = index_ray(scene, field.geometry(), rays[i]);
    const std::vector<CellSpan> spans = field.spans(ray);
    const Crossings found = field.crossings(ray, scene.volumes[0].isosurfaces[0].value);
    tally.cells += long(spans.size());
    ++tally.rays;
    if (spans.empty() || found.hits.empty() || found.clearance < kUndecidable) continue;
    ++tally.hits;
    const Crossing& hit = found.hits.front();
    const double cells_per_mm = glm::length(ray.direction);
    const double depth = hit.t_mm - spans.front().begin_mm;
    const double off = std::abs(depth_mm_from(picture[i].red) - depth) * cells_per_mm;
    // What rounding of a sum over the segments before leaves of the depth: a random walk.
    const double resolution = (std::sqrt(segments_per_mm * depth) + 4) * 0x1p-24 /
                              (kExtinction * std::exp(-kExtinction * depth)) * cells_per_mm;
    tally.worst_resolution = std::max(tally.worst_resolution, resolution);
    const double allowed = std::max(kPlace, unsure / std::max(hit.slope, 1e-3));
    if (picture[i].green == 0)
      ++tally.missed;
    else if (off > allowed + resolution)
      ++tally.misplaced;
    if (hit.slope > 0.1) tally.worst_cells = std::max(tally.worst_cells, off);
  }
}

std::vector<PixelPosition> random_rays(int count, Random& random) {
  std::vector<PixelPosition> rays;
  for (int i = 0; i < count; ++i) rays.push_back({float(random(0, 64)), float(random(0, 64))});
  return rays;
}

// Half of the cameras inside the volume, half around it.
Camera random_camera(int n, Random& random) {
  const glm::dvec3 centre(0.5 * (n - 1));
  const glm::dvec3 target = random.point(0.3 * n, 0.6 * n);
  glm::dvec3 place = random.point(0, n - 1);
  if (random(0, 1) < 0.5) place = centre + glm::normalize(random.point(-1, 1)) * (2.0 * n);
  return Camera{place, target, glm::normalize(random.point(-1, 1)), 40};
}

}  // namespace goldthread::test
