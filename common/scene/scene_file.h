// SPDX-License-Identifier: Apache-2.0
#pragma once
// The scene file: JSON text to a Scene and back. Whatever the text holds, the answer is a Scene in
// which every number is finite and in range, or one Failure that names the file and the field.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "common/scene/scene.h"

namespace goldthread {

/// A scene file may not be larger, nor nest deeper.
constexpr std::size_t kMaxSceneBytes = std::size_t{4} << 20;
constexpr int kMaxSceneDepth = 32;
/// Lists in a scene may not be longer.
constexpr std::size_t kMaxNodes = 16384;
constexpr std::size_t kMaxLights = 64;
constexpr std::size_t kMaxIsosurfaces = 64;
/// Coordinates and lengths reach this far, in millimetres; data values as far as a float does.
constexpr double kMaxLength = 1e9;
constexpr double kMaxValue = 3.4e38;

/// What the text may say beyond (or short of) a user's scene file.
struct SceneParseOptions {
  /// Accepts what scene_to_json adds with `internal`: the top-level key "step", "sizeGiven" in
  /// the image, and "colorSpansRange" and "opacitySpansRange" in a transfer function.
  bool allow_internal = false;
  /// False: a volume may lack its "file", and nothing that would open a file is accepted.
  bool allow_files = true;
};

/// Reads the text of a scene file. `where` names it in failures; relative paths in it, also those
/// of colour-map presets (which are read here), are taken from `base_dir`.
Result<Scene> parse_scene(std::string_view json_text, const std::string& where,
                          const std::filesystem::path& base_dir);
Result<Scene> parse_scene(std::string_view json_text, const std::string& where,
                          const std::filesystem::path& base_dir, const SceneParseOptions& options);

/// A scene from a .json file; any other file is taken for a volume and becomes a Scene of just
/// that volume: direct volume rendering, lit by the default headlight with Phong's default
/// coefficients, camera and transfer function left to resolve_scene().
Result<Scene> read_scene(const std::filesystem::path& path);

struct SceneJsonOptions {
  bool paths = true;      ///< with the volumes' "file"
  bool internal = false;  ///< with what a scene file cannot say; see SceneParseOptions
  bool indent = false;    ///< over many lines, for people
};

/// The scene as JSON in pure ASCII. With `internal`, parsing it (with allow_internal) gives an
/// equal Scene, to the last bit of every number; without, it is a scene file as users write it, and
/// the scene must be resolved. Paths must be UTF-8, as read_scene and parse_scene ensure.
std::string scene_to_json(const Scene& scene, const SceneJsonOptions& options = {});

/// The same forms for the camera alone: {"position", "target", "up", "fovy"}.
std::string camera_to_json(const Camera& camera);
Result<Camera> parse_camera(std::string_view json_text, const std::string& where);

}  // namespace goldthread
