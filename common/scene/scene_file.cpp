// SPDX-License-Identifier: Apache-2.0
#include "common/scene/scene_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/text.h"
#include "common/scene/camera.h"
#include "common/scene/color_map_preset.h"
#include "common/scene/json_view.h"
#include "common/scene/text_file.h"

namespace goldthread {
namespace {

constexpr std::int64_t kVersion = 1;
constexpr int kMaxImageEdge = 16384;
constexpr std::size_t kMaxPathBytes = 4096;
constexpr Interval kPositive{1e-9, kMaxLength};
constexpr Interval kUnit{0, 1};
constexpr Interval kFactor{0, 1000};
constexpr Interval kValue{-kMaxValue, kMaxValue};

/// Reads the parts of one scene file.
class SceneReader {
 public:
  SceneReader(const std::filesystem::path& base_dir, const SceneParseOptions& options)
      : base_dir_(base_dir), options_(options) {}

  Scene scene(const JsonView& view) const;
  Camera camera(const JsonView& view) const;

 private:
  void version(const JsonView& view) const;
  ImageSettings image(const JsonView& view) const;
  std::vector<Light> lights(const JsonView& view) const;
  Light light(const JsonView& view) const;
  SceneVolume volume(const JsonView& view) const;
  std::filesystem::path file(const JsonView& view) const;
  Shading shading(const JsonView& view) const;
  TransferFunction transfer_function(const JsonView& view) const;
  TransferFunction preset(const JsonView& view) const;
  TransferFunction preset_object(const JsonView& view) const;
  std::vector<ColorNode> color_nodes(const JsonView& view) const;
  std::vector<OpacityNode> opacity_nodes(const JsonView& view) const;
  std::vector<Isosurface> isosurfaces(const JsonView& view) const;

  std::filesystem::path base_dir_;
  SceneParseOptions options_;
};

/// Ascending node values; equal neighbours make a step.
template <class Node>
void expect_ascending(const std::vector<Node>& nodes, const JsonView& view) {
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    if (nodes[i].value >= nodes[i - 1].value) continue;
    view[i].complain(fmt::format("its value {:g} is below the one before", nodes[i].value),
                     "sort the nodes by value");
    return;
  }
}

void SceneReader::version(const JsonView& view) const {
  const JsonView version = view.member("goldthread", "\"goldthread\": 1 marks a scene file");
  if (!view.has("goldthread")) return;
  const std::int64_t number = version.integer(1, 1000000);
  if (number == kVersion) return;
  version.complain(fmt::format("version {} is not known", number),
                   fmt::format("this program reads version {}", kVersion));
}

ImageSettings SceneReader::image(const JsonView& view) const {
  if (options_.allow_internal) {
    view.expect_keys({"width", "height", "background", "colorSpace", "sizeGiven"});
  } else {
    view.expect_keys({"width", "height", "background", "colorSpace"});
  }
  ImageSettings image;
  if (view.has("width") || view.has("height")) {
    const auto edge = [&](const char* key) {
      return static_cast<std::int32_t>(
          view.member(key, "give both width and height").integer(1, kMaxImageEdge));
    };
    image.size = {edge("width"), edge("height")};
    image.size_given = true;
  }
  if (view.has("sizeGiven")) image.size_given = view.member("sizeGiven", "").boolean();
  if (view.has("background")) image.background = view.member("background", "").color();
  if (view.has("colorSpace")) {
    image.color_space =
        static_cast<ColorSpace>(view.member("colorSpace", "").choice({"display", "linear"}));
  }
  return image;
}

Camera SceneReader::camera(const JsonView& view) const {
  view.expect_keys({"position", "target", "up", "fovy"});
  Camera camera;
  camera.position = view.member("position", "give [x, y, z] in mm").vector(kMaxLength);
  camera.target = view.member("target", "give [x, y, z] in mm").vector(kMaxLength);
  camera.up = {0, 0, 1};
  if (view.has("up")) camera.up = view.member("up", "").vector(kMaxLength);
  if (view.has("fovy")) camera.fovy_deg = view.member("fovy", "").number({-kMaxValue, kMaxValue});
  if (const CameraFault fault = camera_fault(camera); fault.any()) {
    JsonView(view.json(), view.path().empty() ? fault.field : view.path() + "." + fault.field,
             view.complaint())
        .complain(fault.what, fault.mend);
  }
  return camera;
}

Light SceneReader::light(const JsonView& view) const {
  Light light;
  if (!view.is_object()) view.expect_keys({});
  const std::size_t type = view.member("type", "\"headlight\", \"directional\" or \"point\"")
                               .choice({"headlight", "directional", "point"});
  if (type == 0) {
    view.expect_keys({"type", "intensity", "color"});
  } else if (type == 1) {
    view.expect_keys({"type", "intensity", "color", "direction"});
    const JsonView member = view.member("direction", "give [x, y, z], towards which it shines");
    const glm::dvec3 direction = member.vector(kMaxLength);
    if (direction == glm::dvec3(0)) member.complain("has no direction", "give a vector not zero");
    light.kind = DirectionalLight{direction};
  } else {
    view.expect_keys({"type", "intensity", "color", "position"});
    light.kind = PointLight{view.member("position", "give [x, y, z] in mm").vector(kMaxLength)};
  }
  if (view.has("intensity")) light.intensity = view.member("intensity", "").number(kFactor);
  if (view.has("color")) light.color = view.member("color", "").color();
  return light;
}

std::vector<Light> SceneReader::lights(const JsonView& view) const {
  std::vector<Light> lights;
  const std::size_t count = view.length(0, kMaxLights, "[ { \"type\": \"headlight\" } ]");
  for (std::size_t i = 0; i < count; ++i) lights.push_back(light(view[i]));
  return lights;
}

std::filesystem::path SceneReader::file(const JsonView& view) const {
  const std::string text = view.text(kMaxPathBytes);
  return text.empty() ? std::filesystem::path() : base_dir_ / text;
}

Shading SceneReader::shading(const JsonView& view) const {
  view.expect_keys({"ambient", "diffuse", "specular", "shininess"});
  Shading shading;
  const auto read = [&](const char* key, double& value, Interval range) {
    if (view.has(key)) value = view.member(key, "").number(range);
  };
  read("ambient", shading.ambient, kFactor);
  read("diffuse", shading.diffuse, kFactor);
  read("specular", shading.specular, kFactor);
  read("shininess", shading.shininess, {1e-9, 1e6});
  return shading;
}

std::vector<ColorNode> SceneReader::color_nodes(const JsonView& view) const {
  std::vector<ColorNode> nodes;
  const std::size_t count = view.length(1, kMaxNodes, "[ [value, red, green, blue], ... ]");
  for (std::size_t i = 0; i < count; ++i) {
    const JsonView node = view[i];
    if (node.length(4, 4, "[value, red, green, blue]") != 4) return nodes;
    nodes.push_back({node[0].number(kValue),
                     {node[1].number(kUnit), node[2].number(kUnit), node[3].number(kUnit)}});
  }
  expect_ascending(nodes, view);
  return nodes;
}

std::vector<OpacityNode> SceneReader::opacity_nodes(const JsonView& view) const {
  std::vector<OpacityNode> nodes;
  const std::size_t count = view.length(1, kMaxNodes, "[ [value, opacity], ... ]");
  for (std::size_t i = 0; i < count; ++i) {
    const JsonView node = view[i];
    if (node.length(2, 2, "[value, opacity]") != 2) return nodes;
    nodes.push_back({node[0].number(kValue), node[1].number(kUnit)});
  }
  expect_ascending(nodes, view);
  return nodes;
}

TransferFunction SceneReader::preset(const JsonView& view) const {
  const std::string reference = view.text(kMaxPathBytes);
  if (!options_.allow_files) {
    view.complain("names a file", "give colour and opacity nodes instead");
  }
  if (view.complaint().any()) return {};
  Result<TransferFunction> read = read_color_map_preset(reference, base_dir_);
  if (read) return *read;
  view.complaint().note(read.failure());
  return {};
}

TransferFunction SceneReader::preset_object(const JsonView& view) const {
  view.expect_keys({"preset", "range", "opacity", "unitDistance"});
  TransferFunction function = preset(view.member("preset", ""));
  if (view.has("range")) {
    const JsonView range = view.member("range", "");
    if (range.length(2, 2, "[least, greatest] data value") != 2) return function;
    const double low = range[0].number(kValue), high = range[1].number(kValue);
    if (!(low < high)) range.complain("is empty", "give [least, greatest] data value");
    const auto stretch = [&](auto& nodes) {
      for (auto& node : nodes) node.value = low + node.value * (high - low);
    };
    stretch(function.color);
    stretch(function.opacity);
    function.color_spans_range = function.opacity_spans_range = false;
  }
  if (view.has("opacity")) {
    function.opacity = opacity_nodes(view.member("opacity", ""));
    function.opacity_spans_range = false;
  }
  if (view.has("unitDistance")) {
    function.unit_distance_mm = view.member("unitDistance", "").number(kPositive);
  }
  return function;
}

TransferFunction SceneReader::transfer_function(const JsonView& view) const {
  if (view.is_string()) return preset(view);
  if (view.has("preset")) return preset_object(view);
  if (options_.allow_internal) {
    view.expect_keys({"unitDistance", "color", "opacity", "colorSpansRange", "opacitySpansRange"});
  } else {
    view.expect_keys({"unitDistance", "color", "opacity", "preset", "range"});
    if (view.has("range")) view.member("range", "").complain("needs a preset", "remove it");
  }
  TransferFunction function;
  if (view.has("unitDistance")) {
    function.unit_distance_mm = view.member("unitDistance", "").number(kPositive);
  }
  function.color = color_nodes(view.member("color", "give [ [value, red, green, blue], ... ]"));
  if (view.has("opacity")) function.opacity = opacity_nodes(view.member("opacity", ""));
  const auto flag = [&](const char* key) {
    return view.has(key) && view.member(key, "").boolean();
  };
  function.color_spans_range = flag("colorSpansRange");
  function.opacity_spans_range = flag("opacitySpansRange");
  return function;
}

std::vector<Isosurface> SceneReader::isosurfaces(const JsonView& view) const {
  std::vector<Isosurface> surfaces;
  const std::size_t count = view.length(0, kMaxIsosurfaces, "[ { \"value\": 80 } ]");
  for (std::size_t i = 0; i < count; ++i) {
    const JsonView entry = view[i];
    entry.expect_keys({"value", "color", "opacity"});
    Isosurface surface;
    surface.value = entry.member("value", "give the data value of the surface").number(kValue);
    if (entry.has("color")) surface.color = entry.member("color", "").color();
    if (entry.has("opacity")) surface.opacity = entry.member("opacity", "").number(kUnit);
    surfaces.push_back(surface);
  }
  return surfaces;
}

SceneVolume SceneReader::volume(const JsonView& view) const {
  view.expect_keys(
      {"name", "file", "component", "mode", "shading", "transferFunction", "isosurfaces"});
  SceneVolume volume;
  if (view.has("name")) volume.name = view.member("name", "").text(256);
  if (view.has("file") && !options_.allow_files) {
    view.member("file", "").complain("names a file", "leave it out");
  } else if (view.has("file") || options_.allow_files) {
    volume.file = file(view.member("file", "give the path of a volume file"));
  }
  if (view.has("component")) {
    volume.component = static_cast<int>(view.member("component", "").integer(0, 1000));
  }
  if (view.has("mode")) {
    volume.mode = static_cast<Mode>(view.member("mode", "").choice({"dvr", "isosurface", "mip"}));
  }
  if (view.has("shading")) volume.shading = shading(view.member("shading", ""));
  if (view.has("transferFunction")) {
    volume.transfer_function = transfer_function(view.member("transferFunction", ""));
  }
  if (view.has("isosurfaces")) volume.isosurfaces = isosurfaces(view.member("isosurfaces", ""));
  return volume;
}

Scene SceneReader::scene(const JsonView& view) const {
  if (view.is_object()) version(view);
  if (options_.allow_internal) {
    view.expect_keys({"goldthread", "image", "camera", "lights", "volumes", "step"});
  } else {
    view.expect_keys({"goldthread", "image", "camera", "lights", "volumes"});
  }
  Scene scene;
  if (view.has("image")) scene.image = image(view.member("image", ""));
  if (view.has("camera")) scene.camera = camera(view.member("camera", ""));
  if (view.has("lights")) scene.lights = lights(view.member("lights", ""));
  const JsonView volumes = view.member("volumes", "give [ { \"file\": \"head.nii.gz\" } ]");
  const std::size_t count = volumes.length(1, 1000, "[ { \"file\": \"head.nii.gz\" } ]");
  if (count > 1) {
    volumes.complain(fmt::format("has {} volumes, and this version renders one", count),
                     "leave one in");
  }
  if (count == 1) scene.volumes.push_back(volume(volumes[0]));
  if (view.has("step")) scene.step_mm = view.member("step", "").number({0, kMaxLength});
  return scene;
}

/// Reads with `read` unless the text or anything in it is wrong.
template <class Value, class Read>
Result<Value> read_text(std::string_view text, const std::string& where, Read read) {
  const auto json = parse_json(text, where, {kMaxSceneBytes, kMaxSceneDepth});
  if (!json) return json.failure();
  Complaint complaint(where);
  Value value = read(JsonView(*json, "", complaint));
  if (complaint.any()) return complaint.failure();
  return value;
}

bool is_utf8(const std::string& text) {
  // A serialiser that has to be strict anyway is the judge.
  try {
    (void)nlohmann::json(text).dump();
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

/// The file's name without the extensions that volume files have.
std::string volume_name(const std::filesystem::path& path) {
  std::filesystem::path name = path.filename();
  if (name.extension() == ".gz") name = name.stem();
  return printable(name.stem().string());
}

}  // namespace

Result<Scene> parse_scene(std::string_view json_text, const std::string& where,
                          const std::filesystem::path& base_dir) {
  return parse_scene(json_text, where, base_dir, {});
}

Result<Scene> parse_scene(std::string_view json_text, const std::string& where,
                          const std::filesystem::path& base_dir, const SceneParseOptions& options) {
  const SceneReader reader(base_dir, options);
  return read_text<Scene>(json_text, where,
                          [&](const JsonView& view) { return reader.scene(view); });
}

Result<Camera> parse_camera(std::string_view json_text, const std::string& where) {
  const SceneReader reader({}, {});
  return read_text<Camera>(json_text, where,
                           [&](const JsonView& view) { return reader.camera(view); });
}

Result<Scene> read_scene(const std::filesystem::path& path) {
  if (!is_utf8(path.string())) {
    return Failure{printable(path.string(), 400), "the file's name is not UTF-8",
                   "rename the file"};
  }
  if (path.extension() == ".json") {
    const Result<std::string> text = read_text_file(path, kMaxSceneBytes);
    if (!text) return text.failure();
    return parse_scene(*text, printable(path.string(), 400), path.parent_path());
  }
  Scene scene;
  SceneVolume volume;
  volume.name = volume_name(path);
  volume.file = path;
  volume.shading = Shading{};
  scene.volumes.push_back(volume);
  return scene;
}

}  // namespace goldthread
