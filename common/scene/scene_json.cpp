// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "common/scene/scene_file.h"

namespace goldthread {
namespace {

// Keys in the order in which people write them.
using Json = nlohmann::ordered_json;

template <class... Kinds>
struct Visitor : Kinds... {
  using Kinds::operator()...;
};
template <class... Kinds>
Visitor(Kinds...) -> Visitor<Kinds...>;  // clang before 17 does not deduce it

Json json_of(const glm::dvec3& v) { return Json::array({v.x, v.y, v.z}); }

Json json_of(const Camera& camera) {
  return {{"position", json_of(camera.position)},
          {"target", json_of(camera.target)},
          {"up", json_of(camera.up)},
          {"fovy", camera.fovy_deg}};
}

Json json_of(const Light& light) {
  Json json =
      std::visit(Visitor{[](const Headlight&) -> Json {
                           return {{"type", "headlight"}};
                         },
                         [](const DirectionalLight& kind) -> Json {
                           return {{"type", "directional"}, {"direction", json_of(kind.direction)}};
                         },
                         [](const PointLight& kind) -> Json {
                           return {{"type", "point"}, {"position", json_of(kind.position_mm)}};
                         }},
                 light.kind);
  json["intensity"] = light.intensity;
  json["color"] = json_of(light.color);
  return json;
}

Json json_of(const Shading& shading) {
  return {{"ambient", shading.ambient},
          {"diffuse", shading.diffuse},
          {"specular", shading.specular},
          {"shininess", shading.shininess}};
}

Json json_of(const TransferFunction& function, const SceneJsonOptions& options) {
  Json json = {{"unitDistance", function.unit_distance_mm}, {"color", Json::array()}};
  for (const ColorNode& node : function.color) {
    json["color"].push_back(Json::array({node.value, node.rgb.r, node.rgb.g, node.rgb.b}));
  }
  // Absent says that it is still to be chosen.
  if (!function.opacity.empty()) json["opacity"] = Json::array();
  for (const OpacityNode& node : function.opacity) {
    json["opacity"].push_back(Json::array({node.value, node.alpha}));
  }
  if (options.internal && function.color_spans_range) json["colorSpansRange"] = true;
  if (options.internal && function.opacity_spans_range) json["opacitySpansRange"] = true;
  return json;
}

Json json_of(const Isosurface& surface) {
  return {
      {"value", surface.value}, {"color", json_of(surface.color)}, {"opacity", surface.opacity}};
}

const char* name_of(Mode mode) {
  switch (mode) {
    case Mode::kDvr:
      return "dvr";
    case Mode::kIsosurface:
      return "isosurface";
    case Mode::kMip:
      return "mip";
  }
  return "";
}

Json json_of(const SceneVolume& volume, const SceneJsonOptions& options) {
  Json json = Json::object();
  if (!volume.name.empty()) json["name"] = volume.name;
  if (options.paths && !volume.file.empty()) json["file"] = volume.file.string();
  if (volume.component) json["component"] = *volume.component;
  json["mode"] = name_of(volume.mode);
  if (volume.shading) json["shading"] = json_of(*volume.shading);
  if (volume.transfer_function) {
    json["transferFunction"] = json_of(*volume.transfer_function, options);
  }
  if (!volume.isosurfaces.empty()) json["isosurfaces"] = Json::array();
  for (const Isosurface& surface : volume.isosurfaces) {
    json["isosurfaces"].push_back(json_of(surface));
  }
  return json;
}

Json json_of(const ImageSettings& image, const SceneJsonOptions& options) {
  Json json = {{"width", image.size.width},
               {"height", image.size.height},
               {"background", json_of(image.background)},
               {"colorSpace", image.color_space == ColorSpace::kLinear ? "linear" : "display"}};
  if (options.internal) json["sizeGiven"] = image.size_given;
  return json;
}

/// Pure ASCII, so that the text fits where an encoding is not known (PNG text chunks are Latin-1).
std::string text_of(const Json& json, bool indent) {
  return json.dump(indent ? 2 : -1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace

std::string scene_to_json(const Scene& scene, const SceneJsonOptions& options) {
  Json json = {{"goldthread", 1}, {"image", json_of(scene.image, options)}};
  if (scene.camera) json["camera"] = json_of(*scene.camera);
  json["lights"] = Json::array();
  for (const Light& light : scene.lights) json["lights"].push_back(json_of(light));
  json["volumes"] = Json::array();
  for (const SceneVolume& volume : scene.volumes) {
    json["volumes"].push_back(json_of(volume, options));
  }
  if (options.internal) json["step"] = scene.step_mm;
  return text_of(json, options.indent);
}

std::string camera_to_json(const Camera& camera) { return text_of(json_of(camera), false); }

}  // namespace goldthread
