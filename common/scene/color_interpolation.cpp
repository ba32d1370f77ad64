// SPDX-License-Identifier: Apache-2.0
#include "common/scene/color_interpolation.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace goldthread {
namespace {

constexpr double kPi = glm::pi<double>();

// ---- sRGB and CIE L*a*b* ----

/// The white of D65 as VTK has it, so that its maps come out as VTK's.
const glm::dvec3 kWhite{0.9505, 1.0, 1.089};

double decode(double v) { return v > 0.04045 ? std::pow((v + 0.055) / 1.055, 2.4) : v / 12.92; }
double encode(double v) { return v > 0.0031308 ? 1.055 * std::pow(v, 1 / 2.4) - 0.055 : 12.92 * v; }

double lab_curve(double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; }
double lab_curve_inverse(double f) {
  const double cube = f * f * f;
  return cube > 0.008856 ? cube : (f - 16.0 / 116) / 7.787;
}

glm::dvec3 lab_from_rgb(const glm::dvec3& rgb) {
  const glm::dvec3 l{decode(rgb.r), decode(rgb.g), decode(rgb.b)};
  const glm::dvec3 xyz{l.r * 0.4124 + l.g * 0.3576 + l.b * 0.1805,
                       l.r * 0.2126 + l.g * 0.7152 + l.b * 0.0722,
                       l.r * 0.0193 + l.g * 0.1192 + l.b * 0.9505};
  const glm::dvec3 f{lab_curve(xyz.x / kWhite.x), lab_curve(xyz.y / kWhite.y),
                     lab_curve(xyz.z / kWhite.z)};
  return {116 * f.y - 16, 500 * (f.x - f.y), 200 * (f.y - f.z)};
}

glm::dvec3 rgb_from_lab(const glm::dvec3& lab) {
  const double y = (lab.x + 16) / 116;
  const double x = lab.y / 500 + y;
  const double z = y - lab.z / 200;
  const glm::dvec3 xyz{kWhite.x * lab_curve_inverse(x), kWhite.y * lab_curve_inverse(y),
                       kWhite.z * lab_curve_inverse(z)};
  glm::dvec3 rgb{encode(xyz.x * 3.2406 + xyz.y * -1.5372 + xyz.z * -0.4986),
                 encode(xyz.x * -0.9689 + xyz.y * 1.8758 + xyz.z * 0.0415),
                 encode(xyz.x * 0.0557 + xyz.y * -0.2040 + xyz.z * 1.0570)};
  // Too bright is dimmed as a whole, which keeps the hue; what is negative is cut.
  const double greatest = std::max({rgb.r, rgb.g, rgb.b});
  if (greatest > 1) rgb /= greatest;
  return glm::max(rgb, glm::dvec3(0));
}

// ---- HSV, each in 0…1 ----

glm::dvec3 hsv_from_rgb(const glm::dvec3& rgb) {
  const double most = std::max({rgb.r, rgb.g, rgb.b});
  const double spread = most - std::min({rgb.r, rgb.g, rgb.b});
  if (spread == 0) return {0, 0, most};
  double sector;
  if (most == rgb.r) {
    sector = (rgb.g - rgb.b) / spread;
  } else if (most == rgb.g) {
    sector = 2 + (rgb.b - rgb.r) / spread;
  } else {
    sector = 4 + (rgb.r - rgb.g) / spread;
  }
  return {(sector < 0 ? sector + 6 : sector) / 6, spread / most, most};
}

glm::dvec3 rgb_from_hsv(const glm::dvec3& hsv) {
  const auto channel = [&](double offset) {
    const double k = std::fmod(offset + hsv.x * 6, 6.0);
    return hsv.z - hsv.z * hsv.y * std::clamp(std::min(k, 4 - k), 0.0, 1.0);
  };
  return {channel(5), channel(3), channel(1)};
}

glm::dvec3 mix_hsv(const glm::dvec3& first, const glm::dvec3& second, double share, bool wrap) {
  glm::dvec3 a = hsv_from_rgb(first), b = hsv_from_rgb(second);
  if (wrap && std::abs(a.x - b.x) > 0.5) (a.x < b.x ? a.x : b.x) += 1;
  glm::dvec3 hsv = glm::mix(a, b, share);
  if (hsv.x > 1) hsv.x -= 1;
  return rgb_from_hsv(hsv);
}

// ---- Moreland's Msh: L*a*b* in polar form ----

struct Msh {
  double magnitude, saturation, hue;
};

Msh msh_from_lab(const glm::dvec3& lab) {
  const double magnitude = glm::length(lab);
  const double saturation = magnitude > 0.001 ? std::acos(lab.x / magnitude) : 0;
  const double hue = saturation > 0.001 ? std::atan2(lab.z, lab.y) : 0;
  return {magnitude, saturation, hue};
}

glm::dvec3 lab_from_msh(const Msh& msh) {
  return {msh.magnitude * std::cos(msh.saturation),
          msh.magnitude * std::sin(msh.saturation) * std::cos(msh.hue),
          msh.magnitude * std::sin(msh.saturation) * std::sin(msh.hue)};
}

double angle_between(double a, double b) {
  const double difference = std::abs(a - b);
  return difference > kPi ? 2 * kPi - difference : difference;
}

/// The hue that an unsaturated colour should have beside this saturated one, so that the way
/// between them looks straight.
double spun_hue(const Msh& saturated, double unsaturated_magnitude) {
  if (saturated.magnitude >= unsaturated_magnitude - 0.1) return saturated.hue;
  const double spin = saturated.saturation *
                      std::sqrt(unsaturated_magnitude * unsaturated_magnitude -
                                saturated.magnitude * saturated.magnitude) /
                      (saturated.magnitude * std::sin(saturated.saturation));
  return saturated.hue > -0.3 * kPi ? saturated.hue + spin : saturated.hue - spin;
}

glm::dvec3 mix_diverging(const glm::dvec3& first, const glm::dvec3& second, double share) {
  constexpr double kUnsaturated = 0.05;
  constexpr double kLeastWhite = 88;
  Msh a = msh_from_lab(lab_from_rgb(first)), b = msh_from_lab(lab_from_rgb(second));
  // Two saturated colours of different hue meet in white.
  if (a.saturation > kUnsaturated && b.saturation > kUnsaturated &&
      angle_between(a.hue, b.hue) > 0.33 * kPi) {
    const Msh white{std::max({a.magnitude, b.magnitude, kLeastWhite}), 0, 0};
    (share < 0.5 ? b : a) = white;
    share = share < 0.5 ? 2 * share : 2 * share - 1;
  }
  if (a.saturation < kUnsaturated && b.saturation > kUnsaturated) {
    a.hue = spun_hue(b, a.magnitude);
  } else if (b.saturation < kUnsaturated && a.saturation > kUnsaturated) {
    b.hue = spun_hue(a, b.magnitude);
  }
  return rgb_from_lab(
      lab_from_msh({glm::mix(a.magnitude, b.magnitude, share),
                    glm::mix(a.saturation, b.saturation, share), glm::mix(a.hue, b.hue, share)}));
}

}  // namespace

glm::dvec3 mix_colors(MapSpace space, const glm::dvec3& first, const glm::dvec3& second,
                      double share) {
  switch (space) {
    case MapSpace::kRgb:
      return glm::mix(first, second, share);
    case MapSpace::kHsv:
      return mix_hsv(first, second, share, false);
    case MapSpace::kHsvWrapped:
      return mix_hsv(first, second, share, true);
    case MapSpace::kLab:
      return rgb_from_lab(glm::mix(lab_from_rgb(first), lab_from_rgb(second), share));
    case MapSpace::kDiverging:
      return mix_diverging(first, second, share);
    case MapSpace::kStep:
      return share > 0 ? second : first;
  }
  return first;
}

}  // namespace goldthread
