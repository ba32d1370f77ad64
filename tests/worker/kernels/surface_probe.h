// SPDX-License-Identifier: Apache-2.0
#pragma once
// How hits of isosurfaces are seen from outside: their number through translucent surfaces, the
// place of the first through a medium of constant extinction in front of an opaque one; and the
// comparison of both with bracketing in double, over random cells.

#include <cstdio>
#include <random>

#include "exact_field.h"

namespace goldthread::test {

/// A turn of the field nearer to the isovalue than this (in ranges of the cell) is lost in the
/// rounding of a ray to float; such rays are counted and left out.
constexpr double kUndecidable = 5e-7;

constexpr double kExtinction = 0.3;       // of the medium, 1/mm
constexpr double kSurfaceOpacity = 0.25;  // 24 hits are told apart before a ray counts as opaque

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  double operator()(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  glm::dvec3 point(double low, double high) {
    const double x = (*this)(low, high), y = (*this)(low, high), z = (*this)(low, high);
    return {x, y, z};
  }

 private:
  std::mt19937 generator_;
};

/// A type of voxel and the values that are drawn.
struct Kind {
  VoxelType type;
  double low, high;
  /// Of an isovalue, in data values: int16 is kept as 32768 + value, where a float is good to half
  /// of 1/256.
  double rounding = 0;
  double value(double share) const { return low + (high - low) * share; }
};

/// n³ voxels, every one drawn by itself.
std::shared_ptr<const Volume> random_volume(int n, const Kind& kind, Random& random);
std::vector<PixelPosition> random_rays(int count, Random& random);
/// Half of the cameras inside the volume of n³ voxels, half around it.
Camera random_camera(int n, Random& random);

/// A translucent white surface: each hit leaves 1 − kSurfaceOpacity of the light.
Scene count_scene(const Camera& camera, double isovalue);
int hits_from(float alpha);
/// A red medium in front of an opaque green surface: red is 1 − e^(−kExtinction·depth).
Scene depth_scene(const Camera& camera, double isovalue);
double depth_mm_from(float red);

/// What was compared, printed at the end of each test.
struct Tally {
  long cells = 0, rays = 0, hits = 0, undecidable = 0;
  long missed = 0, false_hits = 0, misplaced = 0;
  double worst_cells = 0;       ///< greatest difference of place, in cells
  double worst_resolution = 0;  ///< the coarsest that a place was seen with, in cells
  void print() const {
    std::printf("  %ld cells, %ld rays, %ld hits; missed %ld, false %ld; undecidable rays %ld\n",
                cells, rays, hits, missed, false_hits, undecidable);
    if (worst_resolution > 0)
      std::printf("  misplaced %ld, greatest %.1e cells, seen to %.1e\n", misplaced, worst_cells,
                  worst_resolution);
  }
};

/// The number of hits of each ray.
void compare_counts(const ExactField& field, const Scene& scene,
                    const std::vector<PixelPosition>& rays, const Picture& picture, Tally& tally);

/// The depths of first hits. A place is right within 1e-5 cell of the oracle's, or where the field
/// is within 4e-7 ranges (and what the kind rounds) of the isovalue: at a shallow crossing the two
/// are far apart. The ray may be cut into `segments_per_mm`, which says how finely depth is seen.
void compare_depths(const ExactField& field, const Scene& scene,
                    const std::vector<PixelPosition>& rays, const Picture& picture,
                    const Kind& kind, double segments_per_mm, Tally& tally);

}  // namespace goldthread::test
