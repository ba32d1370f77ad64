// SPDX-License-Identifier: Apache-2.0
#include "common/image/image_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <numeric>

#include "common/scene/scene_file.h"

namespace goldthread {
namespace {

using testing::HasSubstr;

constexpr ImageSize kSize{7, 5};

std::vector<std::uint8_t> ramp8() {
  std::vector<std::uint8_t> pixels(7 * 5 * 3);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(i * 2);
  return pixels;
}

std::vector<float> ramp32() {
  std::vector<float> pixels(7 * 5 * 4);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<float>(i) / 33 - 1;
  return pixels;
}

std::vector<float> ramp_of_grey() {
  std::vector<float> pixels(7 * 5);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = 1e-7f * static_cast<float>(i * i);
  return pixels;
}

Scene scene() {
  return value_or_throw(
      read_scene(GOLDTHREAD_SOURCE_DIR "/tests/common/scene/data/full_scene.json"));
}

ImageMetadata metadata() {
  return {{kSceneKey, scene_to_json(scene())},
          {kCameraKey, camera_to_json(*scene().camera)},
          {kSoftwareKey, "goldthread test"}};
}

class ImageFile : public testing::Test {
 protected:
  void SetUp() override {
    dir_ =
        std::filesystem::temp_directory_path() / ("goldthread_image_" + std::to_string(::getpid()));
    std::filesystem::create_directories(dir_);
  }
  void TearDown() override { std::filesystem::remove_all(dir_); }

  ImageContent read(const std::string& name) {
    auto content = read_image(dir_ / name);
    EXPECT_TRUE(content.ok()) << content.failure().line();
    return content ? *content : ImageContent{};
  }
  std::size_t files() const {
    const auto list = std::filesystem::directory_iterator(dir_);
    return static_cast<std::size_t>(std::distance(begin(list), end(list)));
  }
  std::filesystem::path dir_;
};

TEST_F(ImageFile, LosslessFormatsGiveEveryByteBack) {
  for (const char* name : {"a.png", "a.tif", "a.TIFF"}) {
    write_rgb8(dir_ / name, kSize, ramp8(), {});
    const ImageContent content = read(name);
    EXPECT_EQ(content.size, kSize);
    ASSERT_EQ(content.channels, 3);
    for (std::size_t i = 0; i < ramp8().size(); ++i) {
      ASSERT_FLOAT_EQ(content.pixels[i] * 255, ramp8()[i]) << name << " " << i;
    }
  }
}

TEST_F(ImageFile, ExrGivesEveryFloatBack) {
  write_rgba32f(dir_ / "a.exr", kSize, ramp32(), {});
  const ImageContent content = read("a.exr");
  EXPECT_EQ(content.size, kSize);
  EXPECT_EQ(content.channels, 4);
  EXPECT_EQ(content.pixels, ramp32());
}

TEST_F(ImageFile, OneFloatAPixelComesBackFromExrAndTiff) {
  for (const char* name : {"a.exr", "a.tif"}) {
    EXPECT_TRUE(can_be_float_image(name));
    write_grey32f(dir_ / name, kSize, ramp_of_grey(), {});
    const ImageContent content = read(name);
    EXPECT_EQ(content.size, kSize);
    EXPECT_EQ(content.channels, 1);
    EXPECT_EQ(content.pixels, ramp_of_grey()) << name;
  }
  EXPECT_FALSE(can_be_float_image("a.png"));
}

TEST_F(ImageFile, JpegIsClose) {
  const std::vector<std::uint8_t> grey(16 * 16 * 3, 100);
  write_rgb8(dir_ / "a.jpg", {16, 16}, grey, metadata());
  for (const float value : read("a.jpg").pixels) EXPECT_NEAR(value * 255, 100, 1.5);
}

TEST_F(ImageFile, TheSceneInAPngParsesToAnEqualScene) {
  write_rgb8(dir_ / "a.png", kSize, ramp8(), metadata());
  const ImageMetadata kept = read("a.png").metadata;
  const auto back = parse_scene(kept.at(kSceneKey), "a.png", "");
  ASSERT_TRUE(back.ok()) << back.failure().line();
  EXPECT_EQ(*back, scene());
  const auto camera = parse_camera(kept.at(kCameraKey), "a.png");
  ASSERT_TRUE(camera.ok());
  EXPECT_EQ(*camera, *scene().camera);
  EXPECT_EQ(kept.at(kSoftwareKey), "goldthread test");
}

TEST_F(ImageFile, TheSceneInAnExrParsesToAnEqualScene) {
  write_rgba32f(dir_ / "a.exr", kSize, ramp32(), metadata());
  const ImageMetadata kept = read("a.exr").metadata;
  const auto back = parse_scene(kept.at(kSceneKey), "a.exr", "");
  ASSERT_TRUE(back.ok()) << back.failure().line();
  EXPECT_EQ(*back, scene());
  EXPECT_EQ(kept.at(kCameraKey), camera_to_json(*scene().camera));
}

TEST_F(ImageFile, JpegAndTiffKeepTheSceneAsDescription) {
  for (const char* name : {"a.jpg", "a.tif"}) {
    write_rgb8(dir_ / name, kSize, ramp8(), metadata());
    EXPECT_EQ(read(name).metadata["ImageDescription"], scene_to_json(scene())) << name;
  }
}

TEST_F(ImageFile, NothingButThePictureIsLeftInTheDirectory) {
  write_rgb8(dir_ / "a.png", kSize, ramp8(), {});
  write_rgb8(dir_ / "a.png", kSize, ramp8(), {});
  EXPECT_EQ(files(), 1u);
}

TEST_F(ImageFile, AMissingDirectoryIsAMachineFailureThatNamesTheFile) {
  try {
    write_rgb8(dir_ / "none" / "a.png", kSize, ramp8(), {});
    FAIL() << "written";
  } catch (const FatalError& error) {
    EXPECT_EQ(error.failure().status, ExitStatus::kClusterFailed);
    EXPECT_EQ(error.failure().where, (dir_ / "none" / "a.png").string());
    EXPECT_THAT(error.what(), HasSubstr("cannot be written"));
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

TEST_F(ImageFile, ADirectoryInThePlaceOfTheFileIsKept) {
  std::filesystem::create_directories(dir_ / "a.png" / "inside");
  EXPECT_THROW(write_rgb8(dir_ / "a.png", kSize, ramp8(), {}), FatalError);
  EXPECT_TRUE(std::filesystem::exists(dir_ / "a.png" / "inside"));
  EXPECT_EQ(files(), 1u);
}

/// A disk that takes no more than this many bytes of one file, as long as it lives.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FullDisk() { ::setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

TEST_F(ImageFile, AFullDiskLeavesTheOldPictureAndNoRest) {
  std::vector<std::uint8_t> noise(256 * 256 * 3);
  std::uint32_t state = 1;
  for (auto& byte : noise)
    byte = static_cast<std::uint8_t>((state = state * 1664525 + 1013904223) >> 24);
  std::vector<float> floats(noise.begin(), noise.end());
  floats.resize(256 * 256 * 4);
  for (const char* name : {"a.png", "a.tif", "a.jpg", "a.exr"}) {
    std::ofstream(dir_ / name) << "old";
    const std::size_t before = files();
    {
      const FullDisk disk(4096);
      if (is_float_image(name)) {
        EXPECT_THROW(write_rgba32f(dir_ / name, {256, 256}, floats, {}), FatalError) << name;
      } else {
        EXPECT_THROW(write_rgb8(dir_ / name, {256, 256}, noise, {}), FatalError) << name;
      }
    }
    EXPECT_EQ(files(), before) << name;
    EXPECT_EQ(std::filesystem::file_size(dir_ / name), 3u) << name;
  }
}

TEST_F(ImageFile, PixelsThatDoNotFitTheSizeAreRefused) {
  EXPECT_THROW(write_rgb8(dir_ / "a.png", {7, 6}, ramp8(), {}), FatalError);
  EXPECT_THROW(write_rgb8(dir_ / "a.png", {-7, -5}, ramp8(), {}), FatalError);
  EXPECT_EQ(files(), 0u);
}

TEST_F(ImageFile, WhatIsNoPictureIsNotRead) {
  std::ofstream(dir_ / "a.png") << "text";
  const auto content = read_image(dir_ / "a.png");
  ASSERT_FALSE(content.ok());
  EXPECT_EQ(content.failure().status, ExitStatus::kBadInput);
}

TEST(ImagePath, KnowsItsFormatsInAnyCase) {
  for (const char* path : {"a.png", "b/a.PNG", "a.exr", "a.tif", "a.tiff", "a.jpg", "a.JPEG"}) {
    EXPECT_TRUE(image_path(path).ok()) << path;
  }
  EXPECT_TRUE(is_float_image("a.EXR"));
  EXPECT_FALSE(is_float_image("a.tif"));
}

TEST(ImagePath, OtherExtensionsAreWrongUsage) {
  for (const char* path : {"a", "a.gif", "png", ".png", "a.png.", "dir.png/a", ""}) {
    const auto result = image_path(path);
    ASSERT_FALSE(result.ok()) << path;
    EXPECT_EQ(result.failure().status, ExitStatus::kUsage);
    EXPECT_EQ(result.failure().mend, "write .png, .exr, .tif or .jpg");
  }
}

}  // namespace
}  // namespace goldthread
