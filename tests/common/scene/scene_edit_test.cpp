// SPDX-License-Identifier: Apache-2.0
#include "common/scene/scene_edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/scene/scene_file.h"

namespace goldthread {
namespace {

using testing::HasSubstr;

Scene example() {
  return value_or_throw(parse_scene(R"({"goldthread": 1,
      "camera": {"position": [0, -500, 20], "target": [0, 0, 20]},
      "volumes": [{"file": "/data/head.nii", "shading": {"ambient": 0.3},
        "transferFunction": {"color": [[0, 0, 0, 0], [9, 1, 1, 1]], "opacity": [[0, 0], [9, 1]]},
        "isosurfaces": [{"value": 80}]}]})",
                                    "test", ""));
}

Scene edited(const std::string& edit) {
  const Result<Scene> scene = apply_edit(example(), edit);
  EXPECT_TRUE(scene.ok()) << scene.failure().line();
  return scene ? *scene : Scene{};
}

std::string refusal(const std::string& edit) {
  const Result<Scene> scene = apply_edit(example(), edit);
  return scene ? "accepted" : scene.failure().line();
}

TEST(Edit, AnEmptyOneChangesNothing) { EXPECT_EQ(edited("{}"), example()); }

TEST(Edit, MergesIntoTheFirstVolume) {
  Scene expected = example();
  expected.volumes[0].mode = Mode::kMip;
  expected.volumes[0].shading->diffuse = 0.5;
  EXPECT_EQ(edited(R"({"volume": {"mode": "mip", "shading": {"diffuse": 0.5}}})"), expected);
}

TEST(Edit, ReplacesNodesAsAWhole) {
  Scene expected = example();
  expected.volumes[0].transfer_function->opacity = {{3, 0.25}};
  EXPECT_EQ(edited(R"({"volume": {"transferFunction": {"opacity": [[3, 0.25]]}}})"), expected);
}

TEST(Edit, NullRemoves) {
  Scene expected = example();
  expected.volumes[0].shading.reset();
  expected.volumes[0].transfer_function.reset();
  expected.volumes[0].isosurfaces.clear();
  EXPECT_EQ(
      edited(R"({"volume": {"shading": null, "transferFunction": null, "isosurfaces": null}})"),
      expected);
}

TEST(Edit, SetsLightsBackgroundAndStep) {
  Scene expected = example();
  expected.lights = {Light{DirectionalLight{{0, 0, -1}}, 0.5, {1, 0, 0}}};
  expected.image.background = {0.1, 0.2, 0.3};
  expected.step_mm = 0.25;
  EXPECT_EQ(edited(R"({"background": [0.1, 0.2, 0.3], "step": 0.25, "lights": [{
      "type": "directional", "direction": [0, 0, -1], "intensity": 0.5, "color": [1, 0, 0]}]})"),
            expected);
}

TEST(Edit, SmallEditsKeepEveryOtherBit) {
  Scene scene = example();
  scene.camera->position = {1.0 / 3, -1e-300, 0.1 + 0.2};
  scene.image.size = {37, 41};
  const Result<Scene> result = apply_edit(scene, R"({"background": [0, 0, 0]})");
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(*result, scene);
}

TEST(Edit, CannotNameAFile) {
  EXPECT_EQ(refusal(R"({"volume": {"file": "/etc/passwd"}})"),
            "goldthread: error: edit: volume.file: unknown key (did you mean \"mode\"?)");
  EXPECT_EQ(refusal(R"({"volume": {"transferFunction": "/etc/passwd"}})"),
            "goldthread: error: edit: volume.transferFunction: names a file (give colour and "
            "opacity nodes instead)");
  EXPECT_THAT(refusal(R"({"volume": {"transferFunction": {"preset": "/etc/passwd"}}})"),
              HasSubstr("edit: volume.transferFunction.preset: unknown key"));
}

TEST(Edit, CannotTouchWhatIsNotItsOwn) {
  EXPECT_THAT(refusal(R"({"camera": {}})"), HasSubstr("edit: camera: unknown key"));
  EXPECT_THAT(refusal(R"({"volume": {"name": "x"}})"), HasSubstr("edit: volume.name: unknown key"));
  EXPECT_THAT(refusal(R"({"volume": {"transferFunction": {"colorSpansRange": true}}})"),
              HasSubstr("unknown key"));
}

TEST(Edit, ABadValueIsNamedInTheEditsOwnWords) {
  EXPECT_EQ(
      refusal(R"({"volume": {"shading": {"ambient": -1}}})"),
      "goldthread: error: edit: volume.shading.ambient: is -1, out of range (from 0 to 1000)");
  EXPECT_EQ(refusal(R"({"background": [0, 0, 2]})"),
            "goldthread: error: edit: background[2]: is 2, out of range (from 0 to 1)");
  EXPECT_THAT(refusal(R"({"step": -1})"), HasSubstr("edit: step: is -1"));
  EXPECT_THAT(refusal(R"({"lights": null})"), HasSubstr("edit: lights: must be an array"));
  EXPECT_THAT(refusal(R"({"volume": null})"), HasSubstr("edit: volume: must be an object"));
  EXPECT_THAT(refusal("[]"), HasSubstr("edit: must be an object"));
  EXPECT_THAT(refusal("{\"volume\": "), HasSubstr("edit: line 1, column"));
}

TEST(Edit, IsLimitedInSize) {
  EXPECT_THAT(refusal(std::string(kMaxEditBytes + 1, ' ')), HasSubstr("edit: larger than 1024 KB"));
}

TEST(Edit, ASceneWithoutVolumesIsRefused) { EXPECT_FALSE(apply_edit(Scene{}, "{}").ok()); }

}  // namespace
}  // namespace goldthread
