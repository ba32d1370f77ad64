// SPDX-License-Identifier: Apache-2.0
// Colours and opacities against VTK's own (make_vtk_fixture.py), and what is refused.
#include "common/scene/color_map_preset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

namespace goldthread {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const std::string kData = GOLDTHREAD_SOURCE_DIR "/tests/common/scene/data/";

json read_json(const std::string& file) { return json::parse(std::ifstream(kData + file)); }

TransferFunction read(const std::string& name) {
  const auto function = read_color_map_preset("presets.json#" + name, kData);
  EXPECT_TRUE(function.ok()) << function.failure().line();
  return function.ok() ? *function : TransferFunction{};
}

/// The failure's line of a preset with these members.
std::string refusal(const std::string& text) {
  const auto function = parse_color_map_preset(text, "map.json");
  return function ? "accepted" : function.failure().line();
}

class VtkMap : public testing::TestWithParam<std::string> {};

TEST_P(VtkMap, GivesVtksColoursTo1Part255) {
  for (const json& expected : read_json("vtk_colors.json")) {
    if (expected["name"] != GetParam()) continue;
    const TransferFunction function = read(GetParam());
    ASSERT_TRUE(function.color_spans_range);
    for (std::size_t i = 0; i < expected["shares"].size(); ++i) {
      const double share = expected["shares"][i];
      const glm::dvec3 rgb = function.color_at(share);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(rgb[c], expected["colors"][i][c].get<double>(), 1.0 / 255)
            << "at share " << share << ", channel " << c;
      }
    }
    return;
  }
  FAIL() << "not in the fixture";
}

TEST_P(VtkMap, GivesVtksOpacityWhereItHasPoints) {
  for (const json& expected : read_json("vtk_colors.json")) {
    if (expected["name"] != GetParam() || !expected.contains("opacities")) continue;
    const TransferFunction function = read(GetParam());
    ASSERT_TRUE(function.opacity_spans_range);
    for (std::size_t i = 0; i < expected["shares"].size(); ++i) {
      const double share = expected["shares"][i];
      EXPECT_NEAR(function.opacity_at(share), expected["opacities"][i].get<double>(), 1.0 / 255)
          << "at share " << share;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Presets, VtkMap,
                         testing::Values("Cool to Warm", "X Ray", "Black-Body Radiation",
                                         "Blue to Red Rainbow", "CIELab Blue to Red",
                                         "Blue - Green - Orange", "Hue the short way",
                                         "Hue through greys", "Steps", "Out of gamut",
                                         "Dark and saturated", "One end grey", "Same hue",
                                         "Shaped opacity", "Stepped opacity"),
                         [](const auto& map) {
                           std::string name;
                           for (const char c : map.param) {
                             if (std::isalnum(static_cast<unsigned char>(c))) name += c;
                           }
                           return name;
                         });

TEST(Preset, EveryMapOfTheFixtureIsTested) {
  EXPECT_EQ(read_json("presets.json").size(), 15u);
  EXPECT_EQ(read_json("vtk_colors.json").size(), 15u);
}

TEST(Preset, ItsOwnNodesStayExact) {
  const TransferFunction function = read("CIELab Blue to Red");
  EXPECT_EQ(function.color.front().rgb, glm::dvec3(0, 0.6, 0.749019607843));
  EXPECT_EQ(function.color.back().rgb, glm::dvec3(0.76862745098, 0.466666666667, 0.341176470588));
  EXPECT_EQ(function.color.back().value, 1);
}

TEST(Preset, NodesAscendAndLieInTheUnitCube) {
  for (const json& preset : read_json("presets.json")) {
    const TransferFunction function = read(preset["Name"]);
    for (std::size_t i = 0; i < function.color.size(); ++i) {
      if (i > 0) {
        EXPECT_LE(function.color[i - 1].value, function.color[i].value);
      }
      for (int c = 0; c < 3; ++c) {
        EXPECT_GE(function.color[i].rgb[c], 0);
        EXPECT_LE(function.color[i].rgb[c], 1);
      }
    }
  }
}

TEST(Preset, WithoutANameTheFirstIsTaken) {
  const auto function = read_color_map_preset("presets.json", kData);
  ASSERT_TRUE(function.ok());
  EXPECT_EQ(*function, read("Cool to Warm"));
}

TEST(Preset, ASinglePresetNeedsNoArray) {
  const auto function =
      parse_color_map_preset(R"({"RGBPoints": [5, 0, 0, 0, 15, 1, 0, 0]})", "map.json");
  ASSERT_TRUE(function.ok()) << function.failure().line();
  EXPECT_EQ(function->color_at(0.5), glm::dvec3(0.5, 0, 0));
}

TEST(Preset, WithoutPointsOpacityIsARamp) {
  const TransferFunction function = read("X Ray");
  EXPECT_DOUBLE_EQ(function.opacity_at(0), 0);
  EXPECT_DOUBLE_EQ(function.opacity_at(0.25), 0.25);
  EXPECT_DOUBLE_EQ(function.opacity_at(1), 1);
}

TEST(Preset, AnUnknownNameNamesTheNearest) {
  const auto function = read_color_map_preset("presets.json#Cool to Worm", kData);
  ASSERT_FALSE(function.ok());
  EXPECT_THAT(function.failure().line(),
              HasSubstr("presets.json: holds no preset \"Cool to Worm\" (did you mean \"Cool to "
                        "Warm\"?)"));
}

TEST(Preset, ACategoricalMapIsRefused) {
  EXPECT_EQ(refusal(R"({"IndexedColors": [1, 0, 0, 0, 1, 0]})"),
            "goldthread: error: map.json: IndexedColors: is a categorical map, which has no "
            "colours between its own (export a map with RGBPoints)");
}

TEST(Preset, BadPointsAreRefusedByName) {
  EXPECT_THAT(refusal(R"({"RGBPoints": [0, 0, 0]})"), HasSubstr("map.json: RGBPoints: must have"));
  EXPECT_THAT(refusal(R"({"RGBPoints": [0, 0, 0, 0, 1]})"), HasSubstr("not a multiple of 4"));
  EXPECT_THAT(refusal(R"({"RGBPoints": [0, 0, 0, 2]})"), HasSubstr("RGBPoints[3]: is 2, out of"));
  EXPECT_THAT(refusal(R"({"RGBPoints": [1, 0, 0, 0, 0, 1, 1, 1]})"), HasSubstr("sort the points"));
  EXPECT_THAT(refusal(R"({"ColorSpace": "Lob", "RGBPoints": [0, 0, 0, 0]})"),
              HasSubstr("did you mean \"Lab\"?"));
  EXPECT_THAT(refusal(R"({"UseLogScale": 1, "RGBPoints": [0, 0, 0, 0]})"),
              HasSubstr("UseLogScale: asks for a logarithmic scale"));
  EXPECT_THAT(refusal("[]"), HasSubstr("must have 1 to"));
  EXPECT_THAT(refusal("3"), HasSubstr("must be an object"));
}

TEST(Preset, AMissingFileIsNamed) {
  const auto function = read_color_map_preset("nowhere.json#x", "/nonexistent");
  ASSERT_FALSE(function.ok());
  EXPECT_EQ(function.failure().line(),
            "goldthread: error: /nonexistent/nowhere.json: there is no such file (check the path)");
}

}  // namespace
}  // namespace goldthread
