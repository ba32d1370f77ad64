// SPDX-License-Identifier: Apache-2.0
#include "worker/ray_caster.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>
#include <utility>

#include "common/scene/camera.h"
#include "worker/kernels/kernel_table.h"
#include "worker/kernels/scene_terms.h"
#include "worker/kernels/transfer_table.h"
#include "worker/kernels/visible_cells.h"

namespace goldthread {

class CommittedScene {
 public:
  CommittedScene(const Scene& scene, std::shared_ptr<const Volume> volume)
      : volume_(std::move(volume)), lights_(scene.lights) {
    const VolumeInfo& info = volume_->info();
    const SceneVolume material = in_computing_space(scene.volumes.front(), scene.image.color_space);
    if (scene.image.color_space == ColorSpace::kLinear)
      for (Light& light : lights_) light.color = linear_color(light.color);
    features_ = features_of(material, scene.lights);
    // Ambient light needs no gradient: without the others it is part of the colour.
    const double ambient = material.shading && !features_.shading ? material.shading->ambient : 1.0;
    if (features_.shading) shading_ = *material.shading;

    hits_something_ = glm::all(glm::greaterThan(info.geometry.size, glm::ivec3(1)));
    terms_.step_mm = step_of(scene.step_mm, info.geometry, features_);
    terms_.field = field_layout_of(*volume_);
    terms_.slab = slab_borders_of(*volume_);
    terms_.phong = phong_term_of(shading_, info);
    if (features_.isosurfaces)
      terms_.surfaces = surface_terms_of(material.isosurfaces, volume_->value_bias(), ambient);
    const TransferFunction* function = nullptr;
    if ((features_.dvr || features_.mip) && material.transfer_function) {
      function = &*material.transfer_function;
      rows_.emplace(*function, info, volume_->value_bias(), features_.mip ? 1.0 : ambient,
                    terms_.step_mm);
      terms_.transfer = rows_->view();
    }
    commit_cells(features_.dvr ? function : nullptr, material);
    kernel_ = find_kernel(features_, storage_of(info.type));
  }

  CommittedScene(const CommittedScene&) = delete;
  CommittedScene& operator=(const CommittedScene&) = delete;

  const Features& features() const { return features_; }
  const Kernel& kernel() const { return kernel_; }
  const KernelScene& terms() const { return terms_; }
  const Volume& volume() const { return *volume_; }
  const std::vector<Light>& lights() const { return lights_; }
  const Shading& shading() const { return shading_; }
  /// Of each cell, x fastest.
  std::vector<bool> visible_cells() const {
    std::vector<bool> visible(distances_.size());
    std::transform(distances_.begin(), distances_.end(), visible.begin(),
                   [](std::uint8_t distance) { return (distance & kCellIsVisible) != 0; });
    visible.resize(volume_->cells().size());  // without padding
    return visible;
  }
  /// False where the field has no extent: a volume one voxel thick.
  bool hits_something() const { return hits_something_; }

 private:
  void commit_cells(const TransferFunction* function, const SceneVolume& material) {
    const glm::ivec3 counts = volume_->cell_counts();
    const auto surfaces =
        features_.isosurfaces ? std::span(material.isosurfaces) : std::span<const Isosurface>();
    const double margin = rows_ ? rows_->row_distance() : 0;
    const CellVisibility visible(function, surfaces, volume_->value_bias(), margin);
    const LayerRange layers = volume_->layers();
    distances_ = cell_distances(volume_->cells(), {counts.x, counts.y, layers.count()}, visible);
    const std::int64_t missing = std::int64_t(layers.first) * counts.x * counts.y;
    terms_.cells = {{counts.x, counts.y, counts.z},
                    distances_.data() - missing,
                    volume_->cells().data() - missing};
  }

  std::shared_ptr<const Volume> volume_;
  std::vector<Light> lights_;
  Shading shading_;
  Features features_;
  Kernel kernel_;
  KernelScene terms_;
  std::optional<TransferRows> rows_;
  std::vector<std::uint8_t> distances_;
  bool hits_something_ = false;
};

namespace {

class RayCaster final : public SampleSource, public SlabCaster {
 public:
  RayCaster(std::shared_ptr<const CommittedScene> scene, const Camera& camera, ImageSize size)
      : scene_(std::move(scene)),
        view_(
            kernel_view_of(camera, camera_basis(camera), size, scene_->volume().info().geometry)) {
    if (scene_->features().shading)
      view_.lights = light_terms_of(scene_->lights(), scene_->shading(), camera,
                                    scene_->volume().info().geometry);
  }

  CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                  std::span<std::uint32_t> surfaces) const override {
    std::ranges::fill(surfaces, 0U);
    if (!scene_->hits_something()) {
      std::fill_n(samples.begin(), positions.size(), Sample{});
      return {.rays = positions.size()};
    }
    return scene_->kernel().cast({scene_->terms(), view_, positions, samples, surfaces});
  }

  CastCounts advance(const RaySpan& rays, Stage stage) const override {
    if (!scene_->hits_something()) return {.rays = rays.positions.size()};
    return scene_->kernel().cast(
        {scene_->terms(), view_, rays.positions, rays.samples, rays.surfaces, stage});
  }

  bool has_surfaces() const override { return scene_->features().isosurfaces; }
  bool seeks_greatest() const override { return scene_->features().mip; }

 private:
  std::shared_ptr<const CommittedScene> scene_;
  KernelView view_;
};

}  // namespace

std::shared_ptr<const CommittedScene> commit_scene(const Scene& scene,
                                                   std::shared_ptr<const Volume> volume) {
  return std::make_shared<const CommittedScene>(scene, std::move(volume));
}

std::vector<std::string> feature_names(const CommittedScene& scene) {
  return names_of(scene.features());
}

std::string kernel_name(const CommittedScene& scene) {
  std::string name;
  for (const std::string& feature : feature_names(scene))
    name += (name.empty() ? "" : "+") + feature;
  name += std::string(" ") + name_of(scene.volume().info().type);
  return name + " " + instruction_set();
}

std::vector<glm::dvec3> visible_points(const CommittedScene& scene, std::size_t most) {
  const Volume& volume = scene.volume();
  const auto is_visible = scene.visible_cells();
  const glm::ivec3 counts = volume.cell_counts();
  const VolumeGeometry& geometry = volume.info().geometry;
  const LayerRange layers = volume.layers();
  const std::size_t in_layer = static_cast<std::size_t>(counts.x) * counts.y;
  const std::size_t begin = in_layer * (volume.slab().first_layer - layers.first);
  const std::size_t end = in_layer * (volume.slab().last_layer - layers.first);
  const auto seen =
      std::size_t(std::count(is_visible.begin() + begin, is_visible.begin() + end, true));
  // Other slabs may have what this one has not.
  const std::size_t all = volume.is_whole() ? end - begin : 0;
  const std::size_t total = seen > 0 ? seen : all;
  const std::size_t wanted = std::min(most, total);
  std::vector<glm::dvec3> chosen;
  std::size_t passed = 0;
  for (std::size_t i = begin; i < end && chosen.size() < wanted; ++i) {
    if (seen > 0 && !is_visible[i]) continue;
    if (passed++ != chosen.size() * total / wanted) continue;
    const glm::dvec3 place(i % counts.x, i / counts.x % counts.y, layers.first + i / in_layer);
    const glm::dvec3 last(geometry.size - 1);
    chosen.emplace_back(geometry.world_from_index() *
                        glm::dvec4(glm::min(double(kCellEdge) * (place + 0.5), last), 1));
  }
  return chosen;
}

std::shared_ptr<const SampleSource> make_ray_caster(std::shared_ptr<const CommittedScene> scene,
                                                    const Camera& camera, ImageSize size) {
  return std::make_shared<const RayCaster>(std::move(scene), camera, size);
}

std::shared_ptr<const SlabCaster> make_slab_caster(std::shared_ptr<const CommittedScene> scene,
                                                   const Camera& camera, ImageSize size) {
  return std::make_shared<const RayCaster>(std::move(scene), camera, size);
}

double step_mm(const CommittedScene& scene) { return scene.terms().step_mm; }

}  // namespace goldthread
