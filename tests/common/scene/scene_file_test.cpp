// SPDX-License-Identifier: Apache-2.0
// Every key of the scene file, every class of mistake with its line, and the way back to text.
#include "common/scene/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

namespace goldthread {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::filesystem::path kData = GOLDTHREAD_SOURCE_DIR "/tests/common/scene/data";
const std::string kPrefix = "goldthread: error: scene.json: ";

std::string full_text() {
  std::ostringstream text;
  text << std::ifstream(kData / "full_scene.json").rdbuf();
  return text.str();
}

Scene parsed(const std::string& text, const std::filesystem::path& base_dir = {}) {
  const Result<Scene> scene = parse_scene(text, "scene.json", base_dir);
  EXPECT_TRUE(scene.ok()) << scene.failure().line();
  return scene ? *scene : Scene{};
}

std::string refusal(const std::string& text) {
  const Result<Scene> scene = parse_scene(text, "scene.json", kData);
  if (scene) return "accepted";
  EXPECT_EQ(scene.failure().status, ExitStatus::kBadInput);
  const std::string line = scene.failure().line();
  EXPECT_THAT(line, StartsWith(kPrefix));
  return line.substr(std::min(kPrefix.size(), line.size()));
}

/// The refusal of the full scene with one value replaced ("/image/width" is a JSON pointer).
std::string refusal_with(const std::string& pointer, const std::string& value) {
  nlohmann::json scene = nlohmann::json::parse(full_text());
  scene[nlohmann::json::json_pointer(pointer)] = nlohmann::json::parse(value);
  return refusal(scene.dump());
}

std::string minimal(const std::string& volume_members = "", const std::string& members = "") {
  return R"({"goldthread": 1, "volumes": [{"file": "a.nii")" +
         (volume_members.empty() ? "" : ", " + volume_members) + "}]" +
         (members.empty() ? "" : ", " + members) + "}";
}

TEST(SceneFile, ReadsEveryKey) {
  const Scene scene = parsed(full_text(), "/data");
  EXPECT_EQ(scene.image.size, (ImageSize{320, 200}));
  EXPECT_TRUE(scene.image.size_given);
  EXPECT_EQ(scene.image.background, glm::dvec3(0.1, 0.2, 0.3));
  EXPECT_EQ(scene.image.color_space, ColorSpace::kLinear);
  EXPECT_EQ(scene.camera, (Camera{{0, -500, 20}, {1, 2, 20}, {0, 0.1, 1}, 35}));
  EXPECT_EQ(scene.lights, (std::vector<Light>{{Headlight{}, 0.5, {1, 1, 1}},
                                              {DirectionalLight{{0, 1, -1}}, 0.25, {1, 0.9, 0.8}},
                                              {PointLight{{100, -200, 300}}, 1, {1, 1, 1}}}));
  ASSERT_EQ(scene.volumes.size(), 1u);
  const SceneVolume& volume = scene.volumes[0];
  EXPECT_EQ(volume.name, "head");
  EXPECT_EQ(volume.file, "/data/ch2.nii.gz");
  EXPECT_EQ(volume.component, 2);
  EXPECT_EQ(volume.mode, Mode::kMip);
  EXPECT_EQ(volume.shading, (Shading{0.1, 0.6, 0.3, 40}));
  ASSERT_TRUE(volume.transfer_function);
  EXPECT_EQ(volume.transfer_function->unit_distance_mm, 2.5);
  EXPECT_EQ(volume.transfer_function->color.size(), 4u);
  EXPECT_EQ(volume.transfer_function->color[1], (ColorNode{60, {0.8, 0.4, 0.3}}));
  EXPECT_EQ(volume.transfer_function->opacity.size(), 5u);
  EXPECT_EQ(volume.transfer_function->opacity[3], (OpacityNode{120, 0.15}));
  EXPECT_FALSE(volume.transfer_function->color_spans_range);
  EXPECT_EQ(volume.isosurfaces, (std::vector<Isosurface>{{80, {0.9, 0.8, 0.7}, 0.5}, {90}}));
}

TEST(SceneFile, WhatIsLeftOutHasItsDefault) {
  Scene expected;
  expected.volumes.emplace_back();
  expected.volumes[0].file = "a.nii";
  const Scene scene = parsed(minimal());
  EXPECT_EQ(scene, expected);
  EXPECT_FALSE(scene.camera);
  EXPECT_EQ(scene.lights, std::vector<Light>{Light{}});
  EXPECT_FALSE(scene.volumes[0].shading);
  EXPECT_FALSE(scene.volumes[0].transfer_function);
}

TEST(SceneFile, AnEmptyListOfLightsIsDark) {
  EXPECT_TRUE(parsed(minimal("", R"("lights": [])")).lights.empty());
}

TEST(SceneFile, PathsAreRelativeToTheSceneUnlessAbsolute) {
  EXPECT_EQ(parsed(minimal(), "some/where").volumes[0].file, "some/where/a.nii");
  EXPECT_EQ(parsed(R"({"goldthread": 1, "volumes": [{"file": "/b.nii"}]})", "some").volumes[0].file,
            "/b.nii");
}

TEST(SceneFile, APresetIsReadBesideTheScene) {
  const Scene scene = parsed(minimal(R"("transferFunction": "presets.json#X Ray")"), kData);
  EXPECT_TRUE(scene.volumes[0].transfer_function->color_spans_range);
  EXPECT_EQ(scene.volumes[0].transfer_function->color[1], (ColorNode{1, {0, 0, 0}}));
}

TEST(SceneFile, APresetObjectTakesRangeOpacityAndUnitDistance) {
  const Scene scene = parsed(minimal(R"("transferFunction": {"preset": "presets.json#X Ray",
      "range": [-100, 300], "opacity": [[0, 0], [200, 0.5]], "unitDistance": 3})"),
                             kData);
  const TransferFunction& function = *scene.volumes[0].transfer_function;
  EXPECT_FALSE(function.color_spans_range);
  EXPECT_FALSE(function.opacity_spans_range);
  EXPECT_EQ(function.color[0].value, -100);
  EXPECT_EQ(function.color[1].value, 300);
  EXPECT_EQ(function.opacity, (std::vector<OpacityNode>{{0, 0}, {200, 0.5}}));
  EXPECT_EQ(function.unit_distance_mm, 3);
}

TEST(SceneFile, UnknownKeysNameTheNearestKnownOne) {
  EXPECT_EQ(refusal(minimal(R"("shadng": {})")),
            "volumes[0].shadng: unknown key (did you mean \"shading\"?)");
  EXPECT_EQ(refusal(minimal("", R"("lihgts": [])")),
            "lihgts: unknown key (did you mean \"lights\"?)");
  EXPECT_EQ(refusal_with("/image/widht", "3"),
            "image.widht: unknown key (did you mean \"width\"?)");
  EXPECT_EQ(refusal_with("/camera/fov", "3"), "camera.fov: unknown key (did you mean \"fovy\"?)");
  EXPECT_EQ(refusal_with("/lights/0/direction", "[0,0,1]"),
            "lights[0].direction: unknown key (did you mean \"intensity\"?)");
  EXPECT_EQ(refusal_with("/volumes/0/shading/shine", "3"),
            "volumes[0].shading.shine: unknown key (did you mean \"shininess\"?)");
  EXPECT_EQ(refusal_with("/volumes/0/transferFunction/colour", "3"),
            "volumes[0].transferFunction.colour: unknown key (did you mean \"color\"?)");
  EXPECT_EQ(refusal_with("/volumes/0/isosurfaces/1/valeu", "3"),
            "volumes[0].isosurfaces[1].valeu: unknown key (did you mean \"value\"?)");
}

TEST(SceneFile, InternalKeysAreNotForUsers) {
  EXPECT_THAT(refusal(minimal("", R"("step": 1)")), StartsWith("step: unknown key"));
  EXPECT_THAT(refusal_with("/image/sizeGiven", "true"), StartsWith("image.sizeGiven: unknown"));
  EXPECT_THAT(refusal_with("/volumes/0/transferFunction/colorSpansRange", "true"),
              StartsWith("volumes[0].transferFunction.colorSpansRange: unknown key"));
}

TEST(SceneFile, AnotherVersionOrNoneIsRefused) {
  EXPECT_EQ(refusal_with("/goldthread", "2"),
            "goldthread: version 2 is not known (this program reads version 1)");
  EXPECT_EQ(refusal("{}"), "goldthread: is missing (\"goldthread\": 1 marks a scene file)");
  EXPECT_EQ(refusal_with("/goldthread", "1.5"),
            "goldthread: must be a whole number, not 1.5 (from 1 to 1000000)");
}

TEST(SceneFile, WrongTypesAreNamed) {
  EXPECT_EQ(refusal("[]"), "must be an object, not an array (write it in braces { })");
  EXPECT_EQ(refusal_with("/image", "3"),
            "image: must be an object, not a number (write it in braces { })");
  EXPECT_EQ(refusal_with("/image/width", "\"3\""),
            "image.width: must be a whole number, not a string (from 1 to 16384)");
  EXPECT_EQ(refusal_with("/camera/fovy", "null"),
            "camera.fovy: must be a number, not null (from -3.4e+38 to 3.4e+38)");
  EXPECT_EQ(refusal_with("/camera/up", "3"),
            "camera.up: must be an array, not a number (write [x, y, z])");
  EXPECT_EQ(refusal_with("/lights", "{}"),
            "lights: must be an array, not an object (write [ { \"type\": \"headlight\" } ])");
  EXPECT_EQ(refusal_with("/volumes/0/file", "true"),
            "volumes[0].file: must be a string, not true or false (write it in quotes)");
  EXPECT_EQ(refusal_with("/volumes/0/mode", "\"dvt\""),
            "volumes[0].mode: is \"dvt\", not \"dvr\", \"isosurface\" or \"mip\" (did you mean "
            "\"dvr\"?)");
}

TEST(SceneFile, NumbersOutOfRangeAreNamed) {
  EXPECT_EQ(refusal_with("/image/width", "0"),
            "image.width: must be a whole number, not 0 (from 1 to 16384)");
  EXPECT_EQ(refusal_with("/image/height", "16385"),
            "image.height: must be a whole number, not 16385 (from 1 to 16384)");
  EXPECT_EQ(refusal_with("/image/background", "[0, 0, 1.01]"),
            "image.background[2]: is 1.01, out of range (from 0 to 1)");
  EXPECT_EQ(refusal_with("/camera/fovy", "0"),
            "camera.fovy: must lie between 0 and 180 degrees (30 is usual)");
  EXPECT_EQ(refusal_with("/camera/fovy", "180"),
            "camera.fovy: must lie between 0 and 180 degrees (30 is usual)");
  EXPECT_EQ(refusal_with("/camera/position/0", "1e10"),
            "camera.position[0]: is 1e+10, out of range (from -1e+09 to 1e+09)");
  EXPECT_EQ(refusal_with("/lights/0/intensity", "-1"),
            "lights[0].intensity: is -1, out of range (from 0 to 1000)");
  EXPECT_THAT(refusal_with("/volumes/0/shading/shininess", "0"),
              StartsWith("volumes[0].shading.shininess: is 0, out of range"));
  EXPECT_THAT(refusal_with("/volumes/0/transferFunction/unitDistance", "0"),
              StartsWith("volumes[0].transferFunction.unitDistance: is 0, out of range"));
  EXPECT_EQ(refusal_with("/volumes/0/transferFunction/opacity/1/1", "1.5"),
            "volumes[0].transferFunction.opacity[1][1]: is 1.5, out of range (from 0 to 1)");
  EXPECT_EQ(refusal_with("/volumes/0/isosurfaces/0/opacity", "-0.5"),
            "volumes[0].isosurfaces[0].opacity: is -0.5, out of range (from 0 to 1)");
  EXPECT_EQ(refusal(minimal("\"component\": -1")),
            "volumes[0].component: must be a whole number, not -1 (from 0 to 1000)");
}

TEST(SceneFile, ANumberBeyondADoubleIsRefused) {
  EXPECT_EQ(refusal("{\"goldthread\": 1,\n \"image\": {\"width\": 1e999}}"),
            "line 2, column 25: a number too large for a double (give a finite number)");
  EXPECT_THAT(refusal("{\"goldthread\": NaN}"), HasSubstr("line 1, column"));
  EXPECT_THAT(refusal("{\"goldthread\": Infinity}"), HasSubstr("not valid JSON"));
}

TEST(SceneFile, NodesMustAscend) {
  EXPECT_EQ(refusal_with("/volumes/0/transferFunction/color/2/0", "59"),
            "volumes[0].transferFunction.color[2]: its value 59 is below the one before (sort the "
            "nodes by value)");
  EXPECT_EQ(refusal_with("/volumes/0/transferFunction/opacity/4/0", "119"),
            "volumes[0].transferFunction.opacity[4]: its value 119 is below the one before (sort "
            "the nodes by value)");
}

TEST(SceneFile, NodesNeedTheirFormAndAtLeastOne) {
  EXPECT_THAT(refusal_with("/volumes/0/transferFunction/color", "[]"),
              StartsWith("volumes[0].transferFunction.color: must have 1 to 16384 entries, not 0"));
  EXPECT_EQ(refusal_with("/volumes/0/transferFunction/opacity/0", "[1, 2, 3]"),
            "volumes[0].transferFunction.opacity[0]: must have 2 entries, not 3 (write [value, "
            "opacity])");
  EXPECT_EQ(refusal(minimal(R"("transferFunction": {})")),
            "volumes[0].transferFunction.color: is missing (give [ [value, red, green, blue], ... "
            "])");
}

TEST(SceneFile, AUselessCameraIsRefused) {
  EXPECT_EQ(refusal_with("/camera/position", "[1, 2, 20]"),
            "camera.target: is the camera's own position (move one of them)");
  EXPECT_EQ(refusal_with("/camera/up", "[-1, -502, 0]"),
            "camera.up: is parallel to the view direction (choose another axis)");
  EXPECT_EQ(refusal_with("/camera/up", "[0, 0, 0]"),
            "camera.up: has no direction ([0, 0, 1] is usual)");
  EXPECT_EQ(refusal_with("/camera", "{\"position\": [0, 0, 0]}"),
            "camera.target: is missing (give [x, y, z] in mm)");
}

TEST(SceneFile, ALightNeedsItsDirectionOrPosition) {
  EXPECT_EQ(refusal_with("/lights/1/direction", "[0, 0, 0]"),
            "lights[1].direction: has no direction (give a vector not zero)");
  EXPECT_EQ(refusal_with("/lights/0/type", "\"point\""),
            "lights[0].position: is missing (give [x, y, z] in mm)");
  EXPECT_THAT(refusal_with("/lights/0/type", "\"area\""), HasSubstr("lights[0].type: is \"area\""));
}

TEST(SceneFile, OneVolumeExactly) {
  EXPECT_EQ(refusal(R"({"goldthread": 1, "volumes": [{"file": "a"}, {"file": "b"}]})"),
            "volumes: has 2 volumes, and this version renders one (leave one in)");
  EXPECT_THAT(refusal(R"({"goldthread": 1, "volumes": []})"), StartsWith("volumes: must have"));
  EXPECT_EQ(refusal(R"({"goldthread": 1})"),
            "volumes: is missing (give [ { \"file\": \"head.nii.gz\" } ])");
  EXPECT_EQ(refusal(R"({"goldthread": 1, "volumes": [{}]})"),
            "volumes[0].file: is missing (give the path of a volume file)");
}

TEST(SceneFile, DoubledKeysAreRefused) {
  EXPECT_EQ(refusal(R"({"goldthread": 1, "goldthread": 1})"),
            "the key \"goldthread\" stands twice in one object (remove one of them)");
}

TEST(SceneFile, BrokenSyntaxIsPlaced) {
  EXPECT_EQ(refusal("{\n  // a comment\n}"),
            "line 2, column 3: not valid JSON (comments are not allowed)");
  EXPECT_EQ(refusal("{\"a\": [1, 2,]}"),
            "line 1, column 13: not valid JSON (is there a comma too many, or a value missing?)");
  EXPECT_THAT(refusal("{\"goldthread\": 1"), HasSubstr("the text ends too early"));
  EXPECT_THAT(refusal(""), HasSubstr("line 1, column 1: not valid JSON"));
  EXPECT_THAT(refusal("{\"name\": \"\xff\"}"), HasSubstr("not valid JSON"));
  EXPECT_THAT(refusal("{} {}"), HasSubstr("line 1, column 4: not valid JSON"));
}

TEST(SceneFile, DeepNestingAndLargeTextsAreRefused) {
  EXPECT_EQ(refusal(std::string(1000000, '[')),
            "nested deeper than 32 levels (a scene needs far "
            "fewer)");
  EXPECT_EQ(refusal(std::string(kMaxSceneBytes + 1, ' ')),
            "larger than 4096 KB (is it the right file?)");
}

TEST(SceneFile, HostileTextStaysOnOneLine) {
  EXPECT_EQ(refusal(R"({"goldthread": 1, "x\n\u001b[31m": 1})"),
            "x??[31m: unknown key (did you mean \"image\"?)");
  EXPECT_EQ(refusal(minimal(R"("name": "a\nb")")),
            "volumes[0].name: holds a control character (remove it)");
  EXPECT_EQ(refusal(R"({"goldthread": 1, "volumes": [{"file": "a\u0000b"}]})"),
            "volumes[0].file: holds a control character (remove it)");
  EXPECT_LT(refusal("{\"goldthread\": 1, \"" + std::string(100000, 'x') + "\": 1}").size(), 200u);
}

TEST(SceneFile, PresetMistakesAreNamed) {
  EXPECT_EQ(refusal(minimal(R"("transferFunction": {"color": [[0,0,0,0]], "range": [0, 1]})")),
            "volumes[0].transferFunction.range: needs a preset (remove it)");
  EXPECT_EQ(refusal(minimal(R"("transferFunction": {"preset": "presets.json", "range": [1, 1]})")),
            "volumes[0].transferFunction.range: is empty (give [least, greatest] data value)");
}

TEST(SceneFile, APresetsOwnFileIsNamedInItsMistakes) {
  const auto scene = parse_scene(minimal(R"("transferFunction": "none.json")"), "s.json", "/no");
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.failure().line(),
            "goldthread: error: /no/none.json: there is no such file (check the path)");
}

TEST(SceneJson, GivesAnEqualSceneBack) {
  const SceneParseOptions internal{.allow_internal = true};
  Scene scene = parsed(full_text(), "/data");
  scene.step_mm = 0.1;
  scene.camera->position = {1.0 / 3, -1e-300, 123456789.123456789};
  scene.volumes[0].transfer_function->unit_distance_mm = std::nextafter(1.0, 2.0);
  scene.volumes[0].transfer_function->color_spans_range = true;
  scene.volumes[0].transfer_function->opacity[0].alpha = 5e-324;
  for (const bool size_given : {true, false}) {
    scene.image.size_given = size_given;
    const auto back = parse_scene(scene_to_json(scene, {.internal = true}), "wire", "", internal);
    ASSERT_TRUE(back.ok()) << back.failure().line();
    EXPECT_EQ(*back, scene);
  }
}

TEST(SceneJson, EachModeAndAnEmptySceneComeBack) {
  for (const Mode mode : {Mode::kDvr, Mode::kIsosurface, Mode::kMip}) {
    Scene scene = parsed(minimal());
    scene.volumes[0].mode = mode;
    scene.lights.clear();
    const auto back =
        parse_scene(scene_to_json(scene, {.internal = true}), "wire", "", {.allow_internal = true});
    ASSERT_TRUE(back.ok());
    EXPECT_EQ(*back, scene);
  }
}

TEST(SceneJson, WithoutInternalsItIsAUsersFile) {
  const Scene scene = parsed(full_text(), "/data");
  EXPECT_EQ(parsed(scene_to_json(scene)), scene);
  EXPECT_EQ(parsed(scene_to_json(scene, {.indent = true})), scene);
}

TEST(SceneJson, LeavesPathsOutOnDemand) {
  const Scene scene = parsed(full_text(), "/secret");
  const std::string text = scene_to_json(scene, {.paths = false});
  EXPECT_THAT(text, testing::Not(HasSubstr("secret")));
  EXPECT_TRUE(parse_scene(text, "wire", "", {.allow_files = false}).ok());
}

TEST(SceneJson, IsPureAscii) {
  Scene scene = parsed(minimal());
  scene.volumes[0].name = "Schädel";
  const std::string text = scene_to_json(scene);
  EXPECT_THAT(text, HasSubstr("Sch\\u00e4del"));
  EXPECT_EQ(parsed(text).volumes, scene.volumes);
}

TEST(CameraJson, GivesAnEqualCameraBack) {
  const Camera camera{{1.0 / 3, 2, 3}, {4, 5, 6.7}, {0, 0.1, 1}, 33.3};
  const auto back = parse_camera(camera_to_json(camera), "camera");
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(*back, camera);
}

TEST(CameraJson, AUselessCameraIsRefused) {
  const auto camera = parse_camera(R"({"position": [0, 0, 0], "target": [0, 0, 0]})", "camera");
  ASSERT_FALSE(camera.ok());
  EXPECT_EQ(camera.failure().line(),
            "goldthread: error: camera: target: is the camera's own position (move one of them)");
}

class SceneOnDisk : public testing::Test {
 protected:
  void SetUp() override {
    dir_ =
        std::filesystem::temp_directory_path() / ("goldthread_scene_" + std::to_string(::getpid()));
    std::filesystem::create_directories(dir_);
  }
  void TearDown() override { std::filesystem::remove_all(dir_); }
  std::filesystem::path dir_;
};

TEST_F(SceneOnDisk, IsReadWithPathsBesideIt) {
  std::ofstream(dir_ / "s.json") << minimal();
  const auto scene = read_scene(dir_ / "s.json");
  ASSERT_TRUE(scene.ok()) << scene.failure().line();
  EXPECT_EQ(scene->volumes[0].file, dir_ / "a.nii");
}

TEST_F(SceneOnDisk, AVolumeFileBecomesALitScene) {
  const auto scene = read_scene(dir_ / "brain.v2.nii.gz");
  ASSERT_TRUE(scene.ok());
  ASSERT_EQ(scene->volumes.size(), 1u);
  EXPECT_EQ(scene->volumes[0].name, "brain.v2");
  EXPECT_EQ(scene->volumes[0].file, dir_ / "brain.v2.nii.gz");
  EXPECT_EQ(scene->volumes[0].mode, Mode::kDvr);
  EXPECT_EQ(scene->volumes[0].shading, Shading{});
  EXPECT_FALSE(scene->camera);
  EXPECT_FALSE(scene->volumes[0].transfer_function);
}

TEST_F(SceneOnDisk, MissingFilesAndFoldersAreRefused) {
  const auto missing = read_scene(dir_ / "none.json");
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.failure().line(), "goldthread: error: " + (dir_ / "none.json").string() +
                                          ": there is no such file (check the path)");
  std::filesystem::create_directory(dir_ / "folder.json");
  const auto folder = read_scene(dir_ / "folder.json");
  ASSERT_FALSE(folder.ok());
  EXPECT_EQ(folder.failure().what, "is not a file");
}

TEST_F(SceneOnDisk, AHugeFileIsRefusedWithoutReadingIt) {
  std::ofstream(dir_ / "huge.json") << "{";
  std::filesystem::resize_file(dir_ / "huge.json", std::uintmax_t{1} << 36);
  const auto scene = read_scene(dir_ / "huge.json");
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.failure().what, "larger than 4096 KB");
}

TEST_F(SceneOnDisk, ANameThatIsNotUtf8IsRefused) {
  const auto scene = read_scene(dir_ / "a\xff.nii");
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.failure().what, "the file's name is not UTF-8");
}

}  // namespace
}  // namespace goldthread
