// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/region_codec.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace goldthread {
namespace {

Picture picture_of(int regions) {
  Picture picture;
  picture.epoch = {0x01020304};
  picture.viewer = 0x11121314;
  picture.serial = 0x21222324;
  picture.size = {0x0403, 0x0605};
  picture.final = true;
  picture.cine_frame = 5;
  picture.cine_frames = 7;
  picture.estimated_error = 0.3125F;
  for (int i = 0; i < regions; ++i) {
    picture.regions.push_back({{0x0102, 0x0203, 0x0301, 0x0402}, 2, {std::byte{9}}});
  }
  return picture;
}

TEST(RegionCodec, EachFieldLiesWhereTheProtocolSays) {
  const RegionHeaderBytes bytes = encode(region_header(picture_of(3), 1, 0x31323334));
  const unsigned char expected[kRegionHeaderBytes] = {
      0x47, 0x54, 0x52, 0x47,                          // 0x47525447, little endian
      0x34, 0x33, 0x32, 0x31,                          // picture
      0x04, 0x03, 0x02, 0x01,                          // epoch
      0x14, 0x13, 0x12, 0x11,                          // viewer
      0x24, 0x23, 0x22, 0x21,                          // serial
      0x02, 0x01, 0x03, 0x02, 0x01, 0x03, 0x02, 0x04,  // x, y, width, height
      0x03, 0x04, 0x05, 0x06,                          // image
      2,    1,    3,    0,                             // encoding, index, count, zero
      1,    5,    7,    0,                             // final, cine frame, cine frames, zero
      0x00, 0x00, 0xa0, 0x3e};                         // estimated error
  for (std::size_t i = 0; i < kRegionHeaderBytes; ++i) {
    EXPECT_EQ(std::to_integer<int>(bytes[i]), expected[i]) << "offset " << i;
  }
}

TEST(RegionCodec, DecodingUndoesEncoding) {
  for (const bool final : {false, true}) {
    Picture picture = picture_of(255);
    picture.final = final;
    for (const std::size_t region : {0, 7, 254}) {
      const RegionHeader header = region_header(picture, region, 4294967295U);
      const Result<RegionHeader> back = decode_region_header(encode(header));
      ASSERT_TRUE(back.ok()) << back.failure().line();
      EXPECT_EQ(*back, header);
    }
  }
}

TEST(RegionCodec, ShortHeadersAreRefused) {
  const RegionHeaderBytes bytes = encode(region_header(picture_of(1), 0, 1));
  for (std::size_t length = 0; length < kRegionHeaderBytes; ++length) {
    EXPECT_FALSE(decode_region_header(std::span(bytes).first(length)).ok()) << length;
  }
}

TEST(RegionCodec, ImpossibleFieldsAreRefused) {
  const RegionHeaderBytes good = encode(region_header(picture_of(3), 1, 1));
  ASSERT_TRUE(decode_region_header(good).ok());
  const std::pair<std::size_t, int> spoilt[] = {{0, 0},  {3, 0},  {21, 0xff}, {32, 0}, {32, 3},
                                                {33, 3}, {34, 1}, {35, 8},    {36, 2}, {37, 0},
                                                {37, 8}, {38, 0}, {38, 6},    {39, 1}, {27, 0xff}};
  for (const auto& [offset, value] : spoilt) {
    RegionHeaderBytes bytes = good;
    bytes[offset] = static_cast<std::byte>(value);
    EXPECT_FALSE(decode_region_header(bytes).ok()) << "offset " << offset << " = " << value;
  }
}

TEST(RegionCodec, AnErrorThatIsNoNumberIsRefused) {
  RegionHeader header = region_header(picture_of(1), 0, 1);
  for (const float error : {-1.0F, 0.0F, 1e30F}) {
    header.estimated_error = error;
    EXPECT_TRUE(decode_region_header(encode(header)).ok()) << error;
  }
  header.estimated_error = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(decode_region_header(encode(header)).ok());
}

TEST(RegionCodec, APictureThatCannotBeSentIsTheCallersBug) {
  EXPECT_NO_THROW(check_picture(picture_of(1)));
  EXPECT_NO_THROW(check_picture(picture_of(255)));
  EXPECT_THROW(check_picture(picture_of(0)), std::invalid_argument);
  EXPECT_THROW(check_picture(picture_of(256)), std::invalid_argument);
  for (const PixelRect rect :
       {PixelRect{-1, 0, 4, 4}, PixelRect{0, 0, 0, 4}, PixelRect{0x0403, 0, 1, 1},
        PixelRect{2147483647, 0, 1, 1}, PixelRect{0, 0, 4, 2147483647}}) {
    Picture picture = picture_of(2);
    picture.regions[1].rect = rect;
    EXPECT_THROW(check_picture(picture), std::invalid_argument);
  }
  Picture wide = picture_of(1);
  wide.size.width = 65536;
  EXPECT_THROW(check_picture(wide), std::invalid_argument);
  for (const auto& [frame, frames] : {std::pair{0, 7}, {8, 7}, {1, 0}, {1, 6}}) {
    Picture cine = picture_of(1);
    cine.cine_frame = static_cast<std::uint8_t>(frame);
    cine.cine_frames = static_cast<std::uint8_t>(frames);
    EXPECT_THROW(check_picture(cine), std::invalid_argument) << frame << " of " << frames;
  }
  Picture unsure = picture_of(1);
  unsure.estimated_error = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(check_picture(unsure), std::invalid_argument);
  Picture coded = picture_of(1);
  coded.regions[0].encoding = 3;
  EXPECT_THROW(check_picture(coded), std::invalid_argument);
}

}  // namespace
}  // namespace goldthread
