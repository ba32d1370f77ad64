// SPDX-License-Identifier: Apache-2.0
#include "compositor/picture_assembly.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace goldthread {
namespace {

constexpr ImageSize kImage{10, 30};

EncodedBand band(std::uint32_t picture, int index, ImageSize image = kImage) {
  EncodedBand result;
  Present& present = result.present;
  present.epoch = {picture + 100};
  present.picture = picture;
  present.viewer = 7;
  present.serial = picture + 1000;
  present.final = picture % 2 == 0;
  present.estimated_error = static_cast<float>(picture);
  result.image = image;
  result.rect = {0, 10 * index, 10, 10};
  result.encoding = 1;
  result.payload = Buffer(1);
  result.payload.data()[0] = static_cast<std::byte>(index);
  return result;
}

EncodedBand cine_band(std::uint32_t picture, std::uint8_t frame, int index) {
  EncodedBand result = band(picture, index);
  result.present.cine_frame = frame;
  result.present.cine_frames = 7;
  return result;
}

TEST(PictureAssembly, TakesItsBandsInAnyOrder) {
  std::array order{0, 1, 2};
  std::uint32_t picture = 0;
  PictureAssembly assembly;
  do {
    EXPECT_FALSE(assembly.add(band(picture, order[0])));
    EXPECT_FALSE(assembly.add(band(picture, order[1])));
    const auto whole = assembly.add(band(picture, order[2]));
    ASSERT_TRUE(whole);
    EXPECT_EQ(whole->epoch, Epoch{picture + 100});
    EXPECT_EQ(whole->viewer, 7u);
    EXPECT_EQ(whole->serial, picture + 1000);
    EXPECT_EQ(whole->size, kImage);
    EXPECT_EQ(whole->final, picture % 2 == 0);
    EXPECT_EQ(whole->estimated_error, static_cast<float>(picture));
    EXPECT_EQ(whole->cine_frames, 0);
    ASSERT_EQ(whole->regions.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(whole->regions[i].rect.y, 10 * order[i]);
      EXPECT_EQ(whole->regions[i].payload, std::vector{static_cast<std::byte>(order[i])});
    }
    ++picture;
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(PictureAssembly, OfOneBandIsWholeAtOnce) {
  PictureAssembly assembly;
  EXPECT_TRUE(assembly.add(band(1, 0, {10, 10})));
}

TEST(PictureAssembly, LetsTheNewestPictureWin) {
  PictureAssembly assembly;
  assembly.add(band(1, 0));
  assembly.add(band(1, 1));
  assembly.add(band(2, 0));
  EXPECT_FALSE(assembly.add(band(1, 2))) << "late";
  EXPECT_FALSE(assembly.add(band(2, 1)));
  const auto whole = assembly.add(band(2, 2));
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->epoch, Epoch{102});
  EXPECT_EQ(whole->regions.size(), 3u);
}

TEST(PictureAssembly, DropsWhatComesAfterItIsWhole) {
  PictureAssembly assembly;
  for (const int i : {0, 1, 2}) assembly.add(band(5, i));
  for (const int i : {0, 1, 2}) EXPECT_FALSE(assembly.add(band(5, i)));
  for (const int i : {0, 1, 2}) EXPECT_FALSE(assembly.add(band(4, i)));
}

TEST(PictureAssembly, IsNotWholeByABandThatComesTwice) {
  PictureAssembly assembly;
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(assembly.add(band(1, 0)));
  EXPECT_FALSE(assembly.add(band(1, 1)));
  EXPECT_TRUE(assembly.add(band(1, 2)));
}

TEST(PictureAssembly, KnowsItsSizeFromItsBandsAlsoWhenTheViewHasChangedSize) {
  // The gateway's compositor may be at a newer view, of another size, when late bands arrive.
  PictureAssembly assembly;
  assembly.add(band(1, 0));
  EXPECT_FALSE(assembly.add(band(1, 1, {10, 20}))) << "bands of two sizes are no picture";
  assembly.add(band(1, 1));
  EXPECT_TRUE(assembly.add(band(1, 2)));
  EXPECT_FALSE(assembly.add(band(2, 0, {10, 20})));
  EXPECT_TRUE(assembly.add(band(2, 1, {10, 20})));
}

TEST(PictureAssembly, PutsFramesOfACineLoopTogetherNextToEachOther) {
  // Each compositor hurries on to the next frame: none may be lost by that.
  PictureAssembly assembly;
  const auto number = [](std::uint8_t frame) { return 10u + frame; };
  for (std::uint8_t frame = 7; frame >= 1; --frame) {
    for (const int i : {0, 1}) EXPECT_FALSE(assembly.add(cine_band(number(frame), frame, i)));
  }
  for (std::uint8_t frame = 1; frame <= 7; ++frame) {
    const auto whole = assembly.add(cine_band(number(frame), frame, 2));
    ASSERT_TRUE(whole) << int{frame};
    EXPECT_EQ(whole->cine_frame, frame);
    EXPECT_EQ(whole->cine_frames, 7);
    EXPECT_EQ(whole->epoch, Epoch{number(frame) + 100});
    EXPECT_FALSE(assembly.add(cine_band(number(frame), frame, 2))) << "once";
  }
}

TEST(PictureAssembly, ForgetsCineFramesThatAreALoopBehind) {
  PictureAssembly assembly;
  for (const int i : {0, 1}) EXPECT_FALSE(assembly.add(cine_band(1, 1, i)));
  EXPECT_FALSE(assembly.add(cine_band(8, 1, 0))) << "the same frame, a loop later";
  EXPECT_FALSE(assembly.add(cine_band(1, 1, 2)));
  EXPECT_FALSE(assembly.add(cine_band(8, 1, 1)));
  EXPECT_TRUE(assembly.add(cine_band(8, 1, 2)));
}

TEST(PictureAssembly, DoesNotMixACineLoopWithOtherPictures) {
  PictureAssembly assembly;
  EXPECT_FALSE(assembly.add(band(1, 0)));
  EXPECT_FALSE(assembly.add(cine_band(2, 1, 0)));
  EXPECT_FALSE(assembly.add(band(1, 1))) << "overtaken by the loop";
  EXPECT_FALSE(assembly.add(band(3, 0)));
  EXPECT_FALSE(assembly.add(cine_band(2, 1, 1))) << "overtaken by a picture";
  EXPECT_FALSE(assembly.add(band(3, 1)));
  EXPECT_TRUE(assembly.add(band(3, 2)));
}

}  // namespace
}  // namespace goldthread
