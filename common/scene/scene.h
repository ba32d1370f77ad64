// SPDX-License-Identifier: Apache-2.0
#pragma once
// A scene as data: what a scene file says, in doubles, world units millimetres (ITK's LPS physical
// space), angles in degrees. A Scene is `resolved` when it lacks nothing a renderer needs.

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/base/types.h"

namespace goldthread {

/// A pinhole camera; `fovy_deg` is the full vertical angle. Pixel rows run from top to bottom.
struct Camera {
  glm::dvec3 position{0, 0, 0};
  glm::dvec3 target{0, 0, 1};
  glm::dvec3 up{0, 1, 0};
  double fovy_deg = 30;
  bool operator==(const Camera&) const = default;
  static constexpr auto fields() {
    return std::tuple{&Camera::position, &Camera::target, &Camera::up, &Camera::fovy_deg};
  }
};

/// Shines from the camera towards what it looks at.
struct Headlight {
  bool operator==(const Headlight&) const = default;
};
/// Shines everywhere towards `direction` (world, need not be normalised).
struct DirectionalLight {
  glm::dvec3 direction{0, 0, 1};
  bool operator==(const DirectionalLight&) const = default;
};
/// Shines from `position_mm` without falling off.
struct PointLight {
  glm::dvec3 position_mm{0, 0, 0};
  bool operator==(const PointLight&) const = default;
};
struct Light {
  std::variant<Headlight, DirectionalLight, PointLight> kind;
  double intensity = 1;
  glm::dvec3 color{1, 1, 1};
  bool operator==(const Light&) const = default;
};

/// Phong's coefficients, two-sided: colour × (ambient + Σ I·diffuse·|n·l|) + Σ
/// I·specular·|r·v|^shininess.
struct Shading {
  double ambient = 0.2;
  double diffuse = 0.7;
  double specular = 0.2;
  double shininess = 20;
  bool operator==(const Shading&) const = default;
};

struct ColorNode {
  double value = 0;
  glm::dvec3 rgb{0, 0, 0};
  bool operator==(const ColorNode&) const = default;
};
struct OpacityNode {
  double value = 0;
  double alpha = 0;
  bool operator==(const OpacityNode&) const = default;
};

/// Colour and opacity over data values: independent nodes in ascending order of value, joined
/// linearly, constant outside. Two nodes of equal value make a step; the later one holds at it.
struct TransferFunction {
  double unit_distance_mm = 1;       ///< opacity is reached over this length
  std::vector<ColorNode> color;      ///< at least one
  std::vector<OpacityNode> opacity;  ///< at least one, unless it is still to be chosen
  bool color_spans_range = false;    ///< node values are 0…1 of the data's range until resolved
  bool opacity_spans_range = false;  ///< the same, for opacity
  bool operator==(const TransferFunction&) const = default;

  glm::dvec3 color_at(double value) const;
  double opacity_at(double value) const;
  /// σ(s) = −ln(1−α(s)) / unitDistance in 1/mm, opacity capped at 1−1e-6.
  double extinction_at(double value) const;
};

struct Isosurface {
  double value = 0;
  glm::dvec3 color{0.9, 0.8, 0.7};
  double opacity = 1;
  bool operator==(const Isosurface&) const = default;
};

enum class Mode : std::uint8_t { kDvr, kIsosurface, kMip };
enum class ColorSpace : std::uint8_t { kDisplay, kLinear };

struct SceneVolume {
  std::string name;
  std::filesystem::path file;    ///< absolute, or relative to the working directory
  std::optional<int> component;  ///< of a multi-component file
  Mode mode = Mode::kDvr;
  std::optional<Shading> shading;  ///< absent: unlit, no gradient is ever computed
  std::optional<TransferFunction> transfer_function;  ///< absent: chosen from the histogram
  std::vector<Isosurface> isosurfaces;
  bool operator==(const SceneVolume&) const = default;
};

struct ImageSettings {
  ImageSize size{512, 512};
  bool size_given = false;  ///< the scene file names a size
  glm::dvec3 background{0, 0, 0};
  ColorSpace color_space = ColorSpace::kDisplay;
  bool operator==(const ImageSettings&) const = default;
};

struct Scene {
  ImageSettings image;
  std::optional<Camera> camera;  ///< absent: chosen to frame the volume
  std::vector<Light> lights{Light{}};
  std::vector<SceneVolume> volumes;
  double step_mm = 0;  ///< upper bound of the ray step; 0: the renderer chooses
  bool operator==(const Scene&) const = default;
};

}  // namespace goldthread
