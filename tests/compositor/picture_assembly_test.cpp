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
  result.present = {{picture + 100}, picture, 7, picture + 1000, false, picture % 2 == 0};
  result.image = image;
  result.rect = {0, 10 * index, 10, 10};
  result.encoding = 1;
  result.spacing_px = static_cast<std::uint8_t>(1 << index);
  result.payload = Buffer(1);
  result.payload.data()[0] = static_cast<std::byte>(index);
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
    EXPECT_EQ(whole->spacing_px, 4) << "the coarsest band's";
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

}  // namespace
}  // namespace goldthread
