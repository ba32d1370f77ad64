// SPDX-License-Identifier: Apache-2.0
// Damaged scene files: whatever comes in, out comes a usable Scene or one failure of one line.
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>

#include "common/scene/camera.h"
#include "common/scene/scene_edit.h"
#include "common/scene/scene_file.h"

namespace goldthread {
namespace {

std::string full_text() {
  std::ostringstream text;
  text << std::ifstream(GOLDTHREAD_SOURCE_DIR "/tests/common/scene/data/full_scene.json").rdbuf();
  return text.str();
}

/// Either a failure fit for a terminal, or a scene whose JSON gives the scene back.
void expect_scene_or_failure(const std::string& text) {
  const Result<Scene> scene = parse_scene(text, "fuzz", "");
  if (!scene) {
    const std::string line = scene.failure().line();
    EXPECT_FALSE(scene.failure().what.empty()) << text;
    EXPECT_FALSE(scene.failure().mend.empty()) << line;
    EXPECT_EQ(line.find_first_of("\n\r\x1b"), line.npos) << line;
    return;
  }
  EXPECT_FALSE(scene->camera && camera_fault(*scene->camera).any()) << text;
  const auto back =
      parse_scene(scene_to_json(*scene, {.internal = true}), "wire", "", {.allow_internal = true});
  ASSERT_TRUE(back.ok()) << back.failure().line() << "\n" << text;
  EXPECT_EQ(*back, *scene) << text;
}

TEST(SceneFuzz, EveryTruncationIsHandled) {
  const std::string text = full_text();
  for (std::size_t length = 0; length <= text.size(); ++length) {
    expect_scene_or_failure(text.substr(0, length));
  }
}

TEST(SceneFuzz, RandomBytesAreHandled) {
  std::mt19937 random(1);
  const std::string text = full_text();
  for (int round = 0; round < 4000; ++round) {
    std::string damaged = text;
    for (auto hits = 1 + random() % 3; hits > 0; --hits) {
      damaged[random() % damaged.size()] = static_cast<char>(random());
    }
    expect_scene_or_failure(damaged);
  }
}

/// Text with one number, string or bracketed part exchanged for something of another kind.
std::string exchange_token(const std::string& text, std::mt19937& random) {
  static const char* const kTokens[] = {
      "null",  "true", "-1",    "0",  "1e308", "1e-308", "[]",    "{}",      "\"\"", "1.5",
      "\"x\"", "[[]]", "1e999", "-0", "256",   "[0,0]",  "16384", "\"dvr\"", "180",  "\"\\u0000\""};
  const auto is_word = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '.';
  };
  std::size_t begin = random() % text.size();
  while (begin + 1 < text.size() && !is_word(text[begin])) ++begin;
  std::size_t end = begin;
  while (end < text.size() && is_word(text[end])) ++end;
  const std::size_t pick = random() % std::size(kTokens);
  return text.substr(0, begin) + kTokens[pick] + text.substr(end);
}

TEST(SceneFuzz, ExchangedTokensAreHandled) {
  std::mt19937 random(2);
  const std::string text = full_text();
  for (int round = 0; round < 6000; ++round) {
    std::string damaged = exchange_token(text, random);
    if (round % 3 == 0) damaged = exchange_token(damaged, random);
    expect_scene_or_failure(damaged);
  }
}

TEST(SceneFuzz, DroppedAndDoubledPartsAreHandled) {
  std::mt19937 random(3);
  const std::string text = full_text();
  for (int round = 0; round < 4000; ++round) {
    const std::size_t begin = random() % text.size();
    const std::size_t length = random() % 60;
    std::string damaged = text;
    if (round % 2 == 0) {
      damaged.erase(begin, length);
    } else {
      damaged.insert(begin, text.substr(random() % text.size(), length));
    }
    expect_scene_or_failure(damaged);
  }
}

TEST(SceneFuzz, DamagedEditsNeverBreakAScene) {
  std::mt19937 random(4);
  const Result<Scene> scene = parse_scene(full_text(), "test", "");
  ASSERT_TRUE(scene.ok());
  const std::string edit = R"({"volume": {"mode": "dvr", "shading": {"ambient": 0.5},
      "transferFunction": {"unitDistance": 1, "color": [[0, 0, 0, 0], [5, 1, 1, 1]],
      "opacity": [[0, 0], [9, 1]]}, "isosurfaces": [{"value": 3}]},
      "lights": [{"type": "headlight"}], "background": [0, 0, 0], "step": 0.5})";
  for (int round = 0; round < 4000; ++round) {
    const Result<Scene> result = apply_edit(*scene, exchange_token(edit, random));
    if (!result) {
      EXPECT_EQ(result.failure().line().find('\n'), std::string::npos);
      continue;
    }
    EXPECT_EQ(result->volumes[0].file, scene->volumes[0].file);
    const auto back = parse_scene(scene_to_json(*result, {.internal = true}), "wire", "",
                                  {.allow_internal = true});
    ASSERT_TRUE(back.ok()) << back.failure().line();
    EXPECT_EQ(*back, *result);
  }
}

}  // namespace
}  // namespace goldthread
