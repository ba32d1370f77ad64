// SPDX-License-Identifier: Apache-2.0
#pragma once
// How far a ray's sample may be from the exact one, derived from its step alone.
//
// Emission and absorption: a rule that takes one sample in the middle of each segment, not longer
// than the step, solves C' = qT, T' = −σT exactly for coefficients q̃, σ̃ that are constant over each
// segment. Over a segment with middle m, |∫σ − σ̃| ≤ ∫ sup_x |σ(m+x) + σ(m−x) − 2σ(m)| / 2, wherever
// the segments lie. With E(t) the integral of that up to t, |T − T̃| ≤ T(e^E − 1), and
// |C − C̃| ≤ ∫ |q − q̃|T̃ + q|T − T̃|. The suprema are taken over points h/6 apart, in double, and
// over what lies between them: turns of the field and nodes of the transfer function. So the bound
// is of second order where the field is smooth, of first order at jumps, and holds for any phase of
// the segments, and for shorter ones.
//
// Added: what the transfer function's table may miss (its second difference over a 2048th of the
// range), rounding to float, and that a ray ends once less than 1/1024 is left to be seen.
//
// The greatest value: the least that any phase of samples a step apart could find, and the colours
// from there to the greatest.

#include "exact_field.h"

namespace goldthread::test {

struct RayBound {
  glm::dvec3 color{0, 0, 0};
  double alpha = 0;
};

class ErrorBound {
 public:
  /// Against a reference that cuts each cell into `reference_substeps` segments.
  ErrorBound(const Scene& scene, const Volume& volume, int reference_substeps);
  RayBound of(PixelPosition position) const;

 private:
  struct Lighting {
    glm::dvec3 scale{1, 1, 1}, shine{0, 0, 0};
    double unsure = 0;  ///< of both, by rounding of the normal
  };
  // What a ray meets at one place.
  struct Point {
    bool finite = false;
    double value = 0;
    double extinction = 0, extinction_unsure = 0;
    glm::dvec3 emission{0, 0, 0}, emission_unsure{0, 0, 0};
    Lighting light;
    glm::dvec3 color{0, 0, 0};
  };

  std::vector<Point> points_on(const IndexRay& ray, double entry, double exit, int count) const;
  Point point(const IndexRay& ray, double t_mm) const;
  Lighting lighting(const IndexRay& ray, const glm::ivec3& cell, const glm::dvec3& index) const;
  RayBound of_absorption(const std::vector<Point>& points, double distance, double ratio) const;
  RayBound of_greatest(const std::vector<Point>& points, int per_step) const;
  glm::dvec4 optics(double value) const;
  void add_what_lies_between(const IndexRay& ray, double entry, double distance,
                             std::vector<Point>& points) const;

  Scene scene_;
  const SceneVolume& material_;
  std::vector<std::pair<double, glm::dvec4>> node_optics_;  ///< by value; steps with both sides
  ExactField field_;
  int substeps_;
  double value_unsure_;    ///< rounding of a value to float
  double table_distance_;  ///< between rows of the table, at most
  double normal_unsure_;   ///< error of a normal times its gradient in the world
};

}  // namespace goldthread::test
