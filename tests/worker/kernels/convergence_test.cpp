// SPDX-License-Identifier: Apache-2.0
// How fast errors fall with the step and with the voxels (Etiene et al. 2014), through the real
// kernels: each study prints its figures and the order fitted to them.

#include <gtest/gtest.h>

#include <cmath>

#include "analytic_fields.h"
#include "every_instruction_set.h"
#include "refinement.h"

namespace goldthread::test {
namespace {

class Order : public EveryInstructionSet {};
GOLDTHREAD_ON_EVERY_INSTRUCTION_SET(Order);

/// Of emission and absorption in the step, as ray_march-inl.h documents it; a rule of higher order
/// may come.
constexpr double kOrderOfStep = 2;
/// Of trilinear interpolation in the voxels' distance.
constexpr double kOrderOfVoxels = 2;
constexpr double kSlack = 0.15;

// ---------------------------------------------------------------- step, on a ramp stored exactly

constexpr double kLength = 32;

double error_on_ramp(const TransferFunction& function, double step, double expected,
                     float Sample::*channel) {
  const auto volume = ramp_along_z(kLength);
  Scene scene = axial_scene(volume->info().geometry, function);
  scene.step_mm = step;
  return std::abs(central_ray(scene, volume).*channel - expected);
}

TEST_P(Order, OfTheStepForARampOfColour) {
  constexpr double kKappa = 0.05, kDepth = kKappa * kLength;
  TransferFunction function = linear_extinction({{0, kKappa}});
  function.color = {{0, {0, 0, 0}}, {1, {1, 1, 1}}};
  const double expected = (1 - (1 + kDepth) * std::exp(-kDepth)) / kDepth;
  const Study found =
      study("colour t/D at constant extinction, step", falling_sizes(8, 6),
            [&](double step) { return error_on_ramp(function, step, expected, &Sample::red); });
  EXPECT_GE(found.order(), kOrderOfStep - kSlack);
}

TEST_P(Order, OfTheStepForAGaussianOfExtinction) {
  // Unsymmetric limits: the errors of symmetric ones cancel.
  constexpr double kPeak = 0.06, kWidth = 8, kMiddle = 10;
  const TransferFunction function = sampled_extinction([&](double value) {
    const double r = (value * kLength - kMiddle) / kWidth;
    return kPeak * std::exp(-0.5 * r * r);
  });
  const double depth = kPeak * kWidth * std::sqrt(std::acos(-1.0) / 2) *
                       (std::erf((kLength - kMiddle) / (kWidth * std::sqrt(2.0))) -
                        std::erf(-kMiddle / (kWidth * std::sqrt(2.0))));
  const Study found = study("Gaussian extinction, step", falling_sizes(5.6, 6), [&](double step) {
    return error_on_ramp(function, step, -std::expm1(-depth), &Sample::alpha);
  });
  EXPECT_GE(found.order(), kOrderOfStep - kSlack);
}

TEST_P(Order, OfTheStepForAnExponentialOfExtinction) {
  constexpr double kFirst = 0.2, kFall = 8;
  const TransferFunction function =
      sampled_extinction([&](double value) { return kFirst * std::exp(-value * kLength / kFall); });
  const double depth = -kFirst * kFall * std::expm1(-kLength / kFall);
  const Study found = study("exponential extinction, step", falling_sizes(4, 6), [&](double step) {
    return error_on_ramp(function, step, -std::expm1(-depth), &Sample::alpha);
  });
  EXPECT_GE(found.order(), kOrderOfStep - kSlack);
}

TEST_P(Order, OfTheStepIsOneWhereExtinctionJumps) {
  // A segment that a jump cuts counts in full or not at all.
  constexpr double kKappa = 0.08, kEdge = 32;
  const auto volume = sampled_cube(kEdge, 9, [](const glm::dvec3& p) { return p.z / kEdge; });
  TransferFunction function = linear_extinction({{0, kKappa}});
  const double alpha = function.opacity.front().alpha;
  function.opacity = {{0, alpha}, {0.5 - 1.0 / 4096, alpha}, {0.5, alpha}, {0.5, 0}};
  Scene scene = oblique_scene(kEdge, function);
  const auto rays = fan(scene, 40);
  const auto expected = [&](PixelPosition position) {
    const WorldRay ray = world_ray(scene, kEdge, position);
    if (!(ray.exit_mm > ray.entry_mm)) return 0.0;
    const double crossing = (0.5 * kEdge - ray.origin.z) / ray.direction.z;
    const double from = std::clamp(crossing, ray.entry_mm, ray.exit_mm);
    // The camera looks down: what lies below the plane comes last.
    return -std::expm1(-kKappa * (ray.exit_mm - from));
  };
  const Study found =
      study("extinction with a jump, step, rms of rays", falling_sizes(4, 7), [&](double step) {
        scene.step_mm = step;
        return rms_opacity_error(scene, volume, rays, expected);
      });
  EXPECT_GE(found.order(), 1 - kSlack);
}

// --------------------------------------------------------- voxels, at a step that does not matter

double order_of_voxels(const char* name, double edge, const std::vector<double>& sizes,
                       const WorldFunction& field, const TransferFunction& function,
                       const std::function<double(const WorldRay&)>& depth) {
  Scene scene = oblique_scene(edge, function);
  scene.step_mm = sizes.back() / 8;
  const auto rays = fan(scene, 24);
  return study(name, sizes,
               [&](double size) {
                 const auto volume = sampled_cube(edge, int(std::lround(edge / size)) + 1, field);
                 return rms_opacity_error(scene, volume, rays, [&](PixelPosition position) {
                   const WorldRay ray = world_ray(scene, edge, position);
                   return ray.exit_mm > ray.entry_mm ? -std::expm1(-depth(ray)) : 0.0;
                 });
               })
      .order();
}

// An edge of 1 in so many cells each.
std::vector<double> sizes_of(std::initializer_list<int> cells) {
  std::vector<double> sizes;
  for (const int count : cells) sizes.push_back(1.0 / count);
  return sizes;
}

TEST_P(Order, OfTheVoxelsForAGaussian) {
  constexpr double kPeak = 3, kWidth = 0.3;
  const glm::dvec3 middle(0.45, 0.55, 0.5);
  const auto field = [&](const glm::dvec3& p) {
    return std::exp(-0.5 * glm::dot(p - middle, p - middle) / (kWidth * kWidth));
  };
  // A·σ·√(π/2)·e^(−b²/2σ²)·[erf((t₁−μ)/σ√2) − erf((t₀−μ)/σ√2)], b the ray's distance, μ its foot.
  const auto depth = [&](const WorldRay& ray) {
    const double foot = glm::dot(middle - ray.origin, ray.direction);
    const glm::dvec3 across = ray.at(foot) - middle;
    const double scale = kWidth * std::sqrt(2.0);
    return kPeak * kWidth * std::sqrt(std::acos(-1.0) / 2) *
           std::exp(-0.5 * glm::dot(across, across) / (kWidth * kWidth)) *
           (std::erf((ray.exit_mm - foot) / scale) - std::erf((ray.entry_mm - foot) / scale));
  };
  EXPECT_NEAR(order_of_voxels("Gaussian, voxels", 1, sizes_of({10, 14, 20, 28, 40}), field,
                              proportional_extinction(kPeak, 1), depth),
              kOrderOfVoxels, kSlack);
}

TEST_P(Order, OfTheVoxelsForAnExponential) {
  constexpr double kFirst = 4, kFall = 0.125;
  const auto field = [](const glm::dvec3& p) { return std::exp(-p.z / kFall); };
  const auto depth = [](const WorldRay& ray) {
    const auto integral = [&](double mm) { return std::exp(-ray.at(mm).z / kFall); };
    return kFirst * kFall / ray.direction.z * (integral(ray.entry_mm) - integral(ray.exit_mm));
  };
  EXPECT_NEAR(order_of_voxels("exponential, voxels", 1, sizes_of({16, 23, 32, 45, 64}), field,
                              proportional_extinction(kFirst, 1), depth),
              kOrderOfVoxels, kSlack);
}

TEST_P(Order, OfTheVoxelsForMarschnerLobb) {
  // A part of their signal; 26 to 100 voxels per wave. Its integral by Simpson's rule.
  constexpr double kPi = 3.14159265358979323846, kWaves = 6, kShare = 0.25;
  const auto field = [](const glm::dvec3& p) {
    const double r = std::hypot(p.x, p.y);
    const double wave = std::cos(2 * kPi * kWaves * std::cos(kPi * r / 2));
    return (1 - std::sin(kPi * p.z / 2) + kShare * (1 + wave)) / (2 * (1 + kShare));
  };
  constexpr double kEdge = 0.5, kScale = 4;
  const auto depth = [&](const WorldRay& ray) {
    constexpr int kPieces = 400;
    const double length = (ray.exit_mm - ray.entry_mm) / kPieces;
    double sum = 0;
    for (int i = 0; i <= 2 * kPieces; ++i) {
      const double weight = i == 0 || i == 2 * kPieces ? 1 : (i % 2 == 1 ? 4 : 2);
      sum += weight * field(ray.at(ray.entry_mm + 0.5 * i * length));
    }
    return kScale * sum * length / 6;
  };
  std::vector<double> sizes = sizes_of({24, 34, 48, 68, 96});
  for (double& size : sizes) size *= kEdge;
  EXPECT_NEAR(order_of_voxels("Marschner-Lobb, voxels", kEdge, sizes, field,
                              proportional_extinction(kScale, 1), depth),
              kOrderOfVoxels, kSlack);
}

// ------------------------------------------------------------------------------ a uniform sphere

// r² about the middle of the cube [0, 2.5]³, opaque inside r = 1.
class Sphere {
 public:
  static constexpr double kEdge = 2.5, kKappa = 0.7;

  Sphere() {
    TransferFunction function = linear_extinction({{0, kKappa}});
    const double alpha = function.opacity.front().alpha;
    // The narrow segment asks for a fine table.
    function.opacity = {{0, alpha}, {1 - 1.0 / 4096, alpha}, {1, alpha}, {1, 0}};
    scene_ = oblique_scene(kEdge, function);
    const glm::dvec3 away = scene_.camera->position - scene_.camera->target;
    scene_.camera->position = scene_.camera->target + glm::normalize(away) * 1e4;
    scene_.camera->fovy_deg = glm::degrees(2 * std::atan(1.05 / 1e4));
    scene_.step_mm = 0.001;
    rays_ = fan(scene_, 48);
  }

  // α(b) = 1 − e^(−2κ√(R²−b²)), b the distance of the ray from the middle.
  double opacity(PixelPosition position) const {
    const WorldRay ray = world_ray(scene_, kEdge, position);
    const glm::dvec3 middle(0.5 * kEdge);
    const glm::dvec3 across = glm::cross(middle - ray.origin, ray.direction);
    const double b2 = glm::dot(across, across);
    return b2 < 1 ? -std::expm1(-2 * kKappa * std::sqrt(1 - b2)) : 0;
  }

  Picture picture(double size) const {
    const auto volume = sampled_cube(kEdge, int(std::lround(kEdge / size)) + 1, [](glm::dvec3 p) {
      return glm::dot(p - 0.5 * kEdge, p - 0.5 * kEdge);
    });
    return cast(scene_, volume, rays_);
  }

  const std::vector<PixelPosition>& rays() const { return rays_; }

 private:
  Scene scene_;
  std::vector<PixelPosition> rays_;
};

const std::vector<double> kSphereSizes = {Sphere::kEdge / 12, Sphere::kEdge / 17,
                                          Sphere::kEdge / 24, Sphere::kEdge / 34,
                                          Sphere::kEdge / 48};

TEST_P(Order, OfTheVoxelsForTheRaysOfAUniformSphere) {
  const Sphere sphere;
  const Study found = study("sphere, voxels, rms of rays", kSphereSizes, [&](double size) {
    const Picture picture = sphere.picture(size);
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < picture.size(); ++i) {
      const double expected = sphere.opacity(sphere.rays()[i]);
      // At the rim √(R²−b²) has no derivative: there the order is lower.
      if (expected < 0.4) continue;
      sum += std::pow(picture[i].alpha - expected, 2);
      ++count;
    }
    return std::sqrt(sum / count);
  });
  EXPECT_NEAR(found.order(), kOrderOfVoxels, kSlack);
}

TEST_P(Order, OfTheVoxelsForTheAverageOverAUniformSphere) {
  const Sphere sphere;
  const Study found = study("sphere, voxels, average", kSphereSizes, [&](double size) {
    const Picture picture = sphere.picture(size);
    double sum = 0;
    for (std::size_t i = 0; i < picture.size(); ++i)
      sum += picture[i].alpha - sphere.opacity(sphere.rays()[i]);
    return std::abs(sum) / double(picture.size());
  });
  EXPECT_NEAR(found.order(), kOrderOfVoxels, kSlack);
}

TEST_P(Order, TheAverageOpacityOfAUniformSphereIsItsClosedForm) {
  // ⟨α⟩ = 1 − 2[1 − (1+y)e^(−y)]/y² over the disc, y = 2κR. A square of ±1.05 was sampled.
  const Sphere sphere;
  constexpr double kY = 2 * Sphere::kKappa;
  const double expected = 1 - 2 * (1 - (1 + kY) * std::exp(-kY)) / (kY * kY);
  double sum = 0;
  const Picture picture = sphere.picture(Sphere::kEdge / 96);
  for (const Sample& sample : picture) sum += sample.alpha;
  const double found = sum / double(picture.size()) * 2.1 * 2.1 / std::acos(-1.0);
  // Voxels: the sphere that they hold is smaller by Δ²/4R, 1.7e-4; pixels: 48 across.
  EXPECT_NEAR(found, expected, 1e-3);
}

}  // namespace
}  // namespace goldthread::test
