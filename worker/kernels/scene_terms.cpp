// SPDX-License-Identifier: Apache-2.0
#include "worker/kernels/scene_terms.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>

#include "common/image/color.h"

namespace goldthread {
namespace {

glm::dmat3 linear_map(const VolumeGeometry& geometry) {
  return glm::dmat3(geometry.direction[0] * geometry.spacing_mm[0],
                    geometry.direction[1] * geometry.spacing_mm[1],
                    geometry.direction[2] * geometry.spacing_mm[2]);
}

void store_rows(const glm::dmat3& matrix, float* rows) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) rows[3 * row + column] = float(matrix[column][row]);
}

template <class T>
void store(const glm::dvec3& v, T* to) {
  for (int i = 0; i < 3; ++i) to[i] = T(v[i]);
}

glm::dvec3 spacing_of(const VolumeGeometry& geometry) {
  const glm::dmat3 map = linear_map(geometry);
  return {glm::length(map[0]), glm::length(map[1]), glm::length(map[2])};
}

double least_of(const glm::dvec3& v) { return std::min({v.x, v.y, v.z}); }

/// The step where none is asked for, in voxels.
double default_voxels(Features features) { return features.dvr && features.shading ? 0.2 : 0.5; }

// v / |v| without overflow; 0 for 0.
glm::dvec3 direction_of(const glm::dvec3& v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return largest > 0 ? glm::normalize(v / largest) : glm::dvec3(0);
}

}  // namespace

glm::dvec3 linear_color(const glm::dvec3& displayed) {
  return {linear_from_srgb(displayed.x), linear_from_srgb(displayed.y),
          linear_from_srgb(displayed.z)};
}

SceneVolume in_computing_space(SceneVolume material, ColorSpace space) {
  if (space == ColorSpace::kDisplay) return material;
  if (material.transfer_function)
    for (ColorNode& node : material.transfer_function->color) node.rgb = linear_color(node.rgb);
  for (Isosurface& surface : material.isosurfaces) surface.color = linear_color(surface.color);
  return material;
}

Features features_of(const SceneVolume& material, const std::vector<Light>& lights) {
  if (material.mode == Mode::kMip) return {.mip = true};
  Features features;
  features.dvr = material.mode == Mode::kDvr;
  features.isosurfaces = material.mode == Mode::kIsosurface || !material.isosurfaces.empty();
  const bool reflects =
      material.shading && (material.shading->diffuse > 0 || material.shading->specular > 0);
  features.shading = reflects && std::any_of(lights.begin(), lights.end(),
                                             [](const Light& l) { return l.intensity > 0; });
  return features;
}

double step_of(double wanted_mm, const VolumeGeometry& geometry, Features features) {
  const glm::dvec3 spacing = spacing_of(geometry);
  const double step = wanted_mm > 0 ? wanted_mm : default_voxels(features) * least_of(spacing);
  return std::max(step, glm::dot(spacing, glm::dvec3(geometry.size)) / (1 << 20));
}

double step_for_error(double error, const VolumeGeometry& geometry, Features features) {
  constexpr double kShare = 0.25;      // of the error; squared it is 1/16 of it
  constexpr double kMostVoxels = 1.9;  // what slabs allow, so that they make the same picture
  const double least = default_voxels(features);
  double voxels = least;
  if (features.dvr && features.shading)
    voxels = std::pow(kShare * error / 1.58, 1 / 1.25);
  else if (features.dvr || features.mip)
    voxels = std::sqrt(kShare * error / 0.17);
  return std::clamp(voxels, least, kMostVoxels) * least_of(spacing_of(geometry));
}

FieldLayout field_layout_of(const Volume& volume) {
  const ColumnLayout& layout = volume.layout();
  FieldLayout field;
  field.voxels = reinterpret_cast<const std::uint8_t*>(volume.voxels()) -
                 std::int64_t(layout.first_slice) * ColumnLayout::kSlice;
  for (int axis = 0; axis < 3; ++axis) {
    field.size[axis] = layout.size[axis];
    field.upper[axis] = std::nextafter(float(layout.size[axis] - 1), 0.0F);
  }
  const Slab& slab = volume.slab();
  // A slab's rays go up to a voxel beyond its border.
  field.lower[2] = float(std::max(slab.first_layer * kCellEdge - 1, 0));
  field.upper[2] =
      std::nextafter(float(std::min(slab.last_layer * kCellEdge + 1, layout.size.z - 1)), 0.0F);
  field.first_origin[2] = layout.first_slice;
  field.last_origin[0] = (layout.columns.x - 2) * ColumnLayout::kEdge;
  field.last_origin[1] = (layout.columns.y - 2) * ColumnLayout::kEdge;
  field.last_origin[2] = layout.first_slice + layout.slices - ColumnLayout::kWindow;
  field.plane_bytes = layout.plane_bytes;
  field.column_bytes = layout.column_bytes();
  field.row_bytes = layout.row_bytes();
  return field;
}

SlabBorders slab_borders_of(const Volume& volume) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Slab& slab = volume.slab();
  const bool is_first = slab.first_layer == 0;
  const bool is_last = slab.last_layer == volume.cell_counts().z;
  return {volume.is_whole(), is_first ? -kInfinity : double(slab.first_layer) * kCellEdge,
          is_last ? kInfinity : double(slab.last_layer) * kCellEdge};
}

std::vector<SurfaceTerm> surface_terms_of(const std::vector<Isosurface>& surfaces,
                                          double value_bias, double color_factor) {
  std::vector<SurfaceTerm> terms;
  for (const Isosurface& surface : surfaces) {
    SurfaceTerm term;
    term.value = float(surface.value - value_bias);
    term.opacity = float(std::clamp(surface.opacity, 0.0, 1.0));
    store(surface.color * color_factor, term.color);
    terms.push_back(term);
  }
  std::stable_sort(terms.begin(), terms.end(),
                   [](const SurfaceTerm& a, const SurfaceTerm& b) { return a.value < b.value; });
  return terms;
}

PhongTerm phong_term_of(const Shading& shading, const VolumeInfo& info) {
  PhongTerm phong;
  phong.ambient = float(shading.ambient);
  phong.shininess = float(shading.shininess);
  const glm::dmat3 map = linear_map(info.geometry);
  // Scaled to the data's range and the finest spacing, so that float neither over- nor underflows.
  const double range = info.maximum > info.minimum ? info.maximum - info.minimum : 1.0;
  const double finest = std::min({glm::length(map[0]), glm::length(map[1]), glm::length(map[2])});
  store_rows(glm::transpose(glm::inverse(map)) * (finest / range), phong.normal_from_gradient);
  store_rows(map, phong.world_from_index);
  return phong;
}

std::vector<LightTerm> light_terms_of(const std::vector<Light>& lights, const Shading& shading,
                                      const Camera& camera, const VolumeGeometry& geometry) {
  std::vector<LightTerm> terms;
  for (const Light& light : lights) {
    LightTerm term;
    store(light.color * (light.intensity * shading.diffuse), term.diffuse);
    store(light.color * (light.intensity * shading.specular), term.specular);
    if (const auto* point = std::get_if<PointLight>(&light.kind)) {
      term.is_point = true;
      store(point->position_mm - geometry.origin_mm, term.vector);
    } else if (const auto* directional = std::get_if<DirectionalLight>(&light.kind)) {
      store(-direction_of(directional->direction), term.vector);
    } else {
      store(-direction_of(camera.target - camera.position), term.vector);
    }
    terms.push_back(term);
  }
  return terms;
}

KernelView kernel_view_of(const Camera& camera, const CameraBasis& basis, ImageSize size,
                          const VolumeGeometry& geometry) {
  const glm::dmat3 index_from_world = glm::inverse(linear_map(geometry));
  KernelView view;
  // Subtracted in the world first: a scene far from the origin keeps its digits.
  store(index_from_world * (camera.position - geometry.origin_mm), view.origin);
  store(index_from_world * basis.forward, view.forward);
  store(index_from_world * basis.right, view.right);
  store(index_from_world * basis.up, view.up);
  view.centre_x = 0.5 * size.width;
  view.centre_y = 0.5 * size.height;
  view.scale = std::tan(0.5 * camera.fovy_deg * glm::pi<double>() / 180.0) / (0.5 * size.height);
  return view;
}

}  // namespace goldthread
