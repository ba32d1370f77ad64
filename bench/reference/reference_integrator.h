// SPDX-License-Identifier: Apache-2.0
#pragma once
// The picture as interfaces.md defines it, integrated by brute force: scalar, in double, cell by
// cell, sharing nothing with the kernels but the scene's and volume's structs. Slow on purpose.

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "common/scene/scene.h"
#include "common/volume/volume.h"

namespace goldthread::reference {

/// Premultiplied colour and opacity, before the background.
struct Radiance {
  glm::dvec3 color{0, 0, 0};
  double alpha = 0;
};

/// A scalar field of voxels in x-fastest order, as data values.
class Integrator {
 public:
  /// `scene` must be resolved; its first volume counts. `substeps` per crossed cell of 2³ voxels:
  /// the error of emission and absorption falls with their square.
  Integrator(Scene scene, VolumeGeometry geometry, std::vector<double> voxels, int substeps = 16);

  /// The ray through a position of the image plane, in pixels.
  Radiance cast(double x, double y) const;

 private:
  struct Ray {
    glm::dvec3 origin, direction;              ///< world, mm, unit length
    glm::dvec3 index_origin, index_direction;  ///< voxels, voxels per mm
  };
  struct Path {
    double transmittance = 1;
    glm::dvec3 color{0, 0, 0};
    double greatest;  ///< −∞ until a value is met
  };
  struct Hit {
    double t;
    const Isosurface* surface;
  };

  Ray ray_through(double x, double y) const;
  std::vector<double> crossings(const Ray& ray) const;
  void cross_cell(const Ray& ray, double begin, double end, Path& path) const;
  void integrate(const Ray& ray, double begin, double end, int substeps, Path& path) const;
  std::vector<Hit> hits_in(const Ray& ray, double begin, double end) const;
  double voxel(int i, int j, int k) const;
  bool cell_is_finite(const glm::ivec3& cell) const;
  bool cell_is_transparent(const glm::ivec3& cell) const;
  double value_in(const glm::ivec3& cell, const glm::dvec3& position) const;
  double value_at(const glm::dvec3& position) const;
  glm::dvec3 world_gradient(const glm::dvec3& position) const;
  glm::dvec3 central_difference(const glm::ivec3& at) const;
  glm::dvec3 lit(const Ray& ray, double t, const glm::dvec3& color) const;
  glm::dvec3 color_of(double value) const;
  double extinction_of(double value) const;
  glm::ivec3 cell_at(const glm::dvec3& position) const;

  Scene scene_;
  SceneVolume material_;
  VolumeGeometry geometry_;
  std::vector<double> voxels_;
  int substeps_;
  glm::dmat3 world_from_index_;
};

/// The voxels of a Volume, for an Integrator.
std::vector<double> voxels_of(const Volume& volume);

}  // namespace goldthread::reference
