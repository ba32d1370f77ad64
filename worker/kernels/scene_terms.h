// SPDX-License-Identifier: Apache-2.0
#pragma once
// From a scene in doubles and world units to the terms that kernels read. Pure functions.

#include <vector>

#include "common/scene/camera.h"
#include "common/scene/scene.h"
#include "common/volume/volume.h"
#include "worker/kernels/kernel_table.h"

namespace goldthread {

/// sRGB to linear light.
glm::dvec3 linear_color(const glm::dvec3& displayed);

/// Colours in the space in which light is added up: as given, or linear where the scene says so.
SceneVolume in_computing_space(SceneVolume material, ColorSpace space);

/// Shading counts only where some light changes the picture; mip knows neither light nor surfaces.
Features features_of(const SceneVolume& material, const std::vector<Light>& lights);

/// The step that is taken where at most `wanted_mm` is asked for. 0: half the smallest spacing, and
/// a fifth of it for emission and absorption with shading, whose highlights turn faster than the
/// field; both keep the default scene's error below 0.25/255. Never so small that a ray has more
/// than 2^20 segments, which float could not count in halves.
double step_of(double wanted_mm, const VolumeGeometry& geometry, Features features);

/// The step, mm, for a picture that may have an RMS error of `error` in 1/255 from all causes: the
/// step alone causes a quarter of it, by what docs/benchmarks.md found on the default scene (0.17
/// at a step of one voxel, second order; with shading 1.58, order 1.25). Never below the default,
/// nor beyond 1.9 voxels, about as far as this was measured; surfaces are found wherever the steps
/// are.
double step_for_error(double error, const VolumeGeometry& geometry, Features features);

FieldLayout field_layout_of(const Volume& volume);
SlabBorders slab_borders_of(const Volume& volume);
std::vector<SurfaceTerm> surface_terms_of(const std::vector<Isosurface>& surfaces,
                                          double value_bias, double color_factor);
PhongTerm phong_term_of(const Shading& shading, const VolumeInfo& info);
std::vector<LightTerm> light_terms_of(const std::vector<Light>& lights, const Shading& shading,
                                      const Camera& camera, const VolumeGeometry& geometry);
KernelView kernel_view_of(const Camera& camera, const CameraBasis& basis, ImageSize size,
                          const VolumeGeometry& geometry);

}  // namespace goldthread
