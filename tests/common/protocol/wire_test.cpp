// SPDX-License-Identifier: Apache-2.0
#include "common/protocol/wire.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "tests/common/protocol/message_values.h"

namespace goldthread {
namespace {

TEST(Message, SurvivesEncodingAndDecoding) {
  for_each_message([]<class Direction, std::size_t Kind>() {
    using Message = MessageOf<Direction, Kind>;
    SCOPED_TRACE(Message::kName);
    const auto decoded =
        decode<Direction>(encode(Direction(std::in_place_index<Kind>, filled<Message>())));
    ASSERT_TRUE(decoded);
    ASSERT_EQ(decoded->index(), Kind);
    EXPECT_TRUE(same(std::get<Kind>(*decoded), filled<Message>()));
  });
}

TEST(Message, OfDefaultValuesSurvives) {
  for_each_message([]<class Direction, std::size_t Kind>() {
    using Message = MessageOf<Direction, Kind>;
    SCOPED_TRACE(Message::kName);
    const auto decoded = decode<Direction>(encode(Direction(std::in_place_index<Kind>)));
    ASSERT_TRUE(decoded);
    EXPECT_TRUE(same(std::get<Kind>(*decoded), Message{}));
  });
}

template <class T>
void expect_all_members_listed() {
  EXPECT_EQ(member_count<T>(), std::tuple_size_v<decltype(T::fields())>) << typeid(T).name();
}

TEST(Message, ListsEachOfItsMembersAsAField) {
  for_each_message([]<class Direction, std::size_t Kind>() {
    expect_all_members_listed<MessageOf<Direction, Kind>>();
  });
  expect_all_members_listed<VolumeInfo>();
  expect_all_members_listed<VolumeGeometry>();
  expect_all_members_listed<Camera>();
  expect_all_members_listed<TileGrid>();
  expect_all_members_listed<SharedBlock>();
  expect_all_members_listed<Step>();
  expect_all_members_listed<Refinement>();
  expect_all_members_listed<DisplaySettings>();
  expect_all_members_listed<TileQuality>();
  expect_all_members_listed<MessageCount>();
  expect_all_members_listed<Failure>();
  expect_all_members_listed<PixelRect>();
  expect_all_members_listed<ImageSize>();
}

TEST(Message, HasANameOfItsOwnInItsDirection) {
  std::set<std::pair<std::size_t, std::string>> names;
  std::size_t count = 0;
  for_each_message([&]<class Direction, std::size_t Kind>() {
    const Direction message(std::in_place_index<Kind>);
    EXPECT_STREQ(message_name(message), (MessageOf<Direction, Kind>::kName));
    names.insert({typeid(Direction).hash_code(), message_name(message)});
    ++count;
  });
  EXPECT_EQ(names.size(), count);
}

TEST(Message, IsLittleEndianWithoutPadding) {
  const Buffer bytes = encode(ToWorker(
      RenderTiles{{{.epoch = {0x04030201}, .tile = {0x08070605}, .from = {5}, .to = {0x0a09}}}}));
  const std::array<int, 17> expected{8, 1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 5, 0, 9, 0x0a};
  ASSERT_EQ(bytes.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(std::to_integer<int>(bytes.data()[i]), expected[i]) << i;
  }
}

TEST(Message, CarriesNanInfinityAndMinusZeroAsTheirBits) {
  for (const double value : {std::nan("0x123"), -std::numeric_limits<double>::infinity(), -0.0,
                             std::numeric_limits<double>::denorm_min()}) {
    const TilesDone sent{{{{7}, {3}, {2}, 100, 20, 10, {value, -value}}}};
    const auto decoded = decode<ToMaster>(encode(ToMaster(sent)));
    ASSERT_TRUE(decoded);
    EXPECT_TRUE(same(std::get<TilesDone>(*decoded), sent)) << value;
  }
}

TEST(Message, CarriesTextWithZerosAndAnyByte) {
  std::string text;
  for (int byte = 0; byte < 256; ++byte) text += static_cast<char>(byte);
  const auto decoded = decode<ToCompositor>(encode(ToCompositor(Broadcast{text})));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(std::get<Broadcast>(*decoded).json, text);
}

template <class Message>
Buffer& payload_of(Message& message) {
  return wire_detail::payload_of(message);
}

TEST(BulkMessage, TravelsWithoutACopyAndAlignedTo16) {
  int bulk = 0;
  for_each_message([&]<class Direction, std::size_t Kind>() {
    using Message = MessageOf<Direction, Kind>;
    if constexpr (wire_detail::is_bulk<Message>()) {
      SCOPED_TRACE(Message::kName);
      ++bulk;
      Message message = filled<Message>();
      const std::byte* const payload = payload_of(message).data();
      const std::size_t size = payload_of(message).size();

      Buffer bytes = encode(Direction(std::in_place_index<Kind>, std::move(message)));
      const std::size_t header = bytes.size() - size;
      EXPECT_EQ(bytes.data() + header, payload) << "encoding copied the payload";
      EXPECT_EQ(header % 16, 0u);

      auto decoded = decode<Direction>(std::move(bytes));
      ASSERT_TRUE(decoded);
      Buffer& received = payload_of(std::get<Kind>(*decoded));
      EXPECT_EQ(received.data(), payload) << "decoding copied the payload";
      EXPECT_EQ(received.size(), size);
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(received.data()) % 16, 0u);
    }
  });
  EXPECT_EQ(bulk, 7)
      << "Samples, BandPicture, EncodedBand, AdvanceRays, RaysAdvanced, and LinkProbe "
         "to two roles";
}

TEST(BulkMessage, IsAlignedTo16AlsoInMemoryMadeForReceiving) {
  for_each_message([]<class Direction, std::size_t Kind>() {
    using Message = MessageOf<Direction, Kind>;
    if constexpr (wire_detail::is_bulk<Message>()) {
      const Buffer sent = encode(Direction(std::in_place_index<Kind>, filled<Message>()));
      Buffer received = Buffer::for_receiving(sent.size());
      std::memcpy(received.data(), sent.data(), sent.size());
      auto decoded = decode<Direction>(std::move(received));
      ASSERT_TRUE(decoded);
      const Buffer& payload = payload_of(std::get<Kind>(*decoded));
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(payload.data()) % 16, 0u);
    }
  });
}

TEST(BulkMessage, WithoutPayloadSurvives) {
  const auto decoded =
      decode<ToCompositor>(encode(ToCompositor(Samples{{1}, {2}, {4}, {5}, 0, {}})));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(std::get<Samples>(*decoded).packed.size(), 0u);
}

}  // namespace
}  // namespace goldthread
