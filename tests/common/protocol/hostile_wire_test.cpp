// SPDX-License-Identifier: Apache-2.0
// What a broken or hostile peer may send: decode refuses it, without a crash and without memory.

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "common/protocol/wire.h"
#include "tests/common/protocol/allocations.h"
#include "tests/common/protocol/message_values.h"

namespace goldthread {
namespace {

Buffer copy_of(std::span<const std::byte> bytes) {
  Buffer copy = Buffer::for_receiving(bytes.size());
  if (!bytes.empty()) std::memcpy(copy.data(), bytes.data(), bytes.size());
  return copy;
}

template <class Direction, std::size_t Kind>
Buffer encoded() {
  return encode(Direction(std::in_place_index<Kind>, filled<MessageOf<Direction, Kind>>()));
}

TEST(HostileMessage, CutShortAtAnyByteIsRefused) {
  for_each_message([]<class Direction, std::size_t Kind>() {
    using Message = MessageOf<Direction, Kind>;
    SCOPED_TRACE(Message::kName);
    const Buffer whole = encoded<Direction, Kind>();
    // A payload has no length of its own: whoever uses it checks it against what it should hold.
    std::size_t checked = whole.size();
    if constexpr (wire_detail::is_bulk<Message>()) {
      Message message = filled<Message>();
      checked -= wire_detail::payload_of(message).size();
    }
    for (std::size_t size = 0; size < checked; ++size) {
      EXPECT_FALSE(decode<Direction>(copy_of(whole.bytes().first(size)))) << size;
    }
  });
}

TEST(HostileMessage, WithAByteTooManyIsRefused) {
  for_each_message([]<class Direction, std::size_t Kind>() {
    using Message = MessageOf<Direction, Kind>;
    if constexpr (!wire_detail::is_bulk<Message>()) {
      SCOPED_TRACE(Message::kName);
      const Buffer whole = encoded<Direction, Kind>();
      Buffer longer(whole.size() + 1);
      std::memcpy(longer.data(), whole.data(), whole.size());
      longer.data()[whole.size()] = std::byte{0};
      EXPECT_FALSE(decode<Direction>(std::move(longer)));
    }
  });
}

template <class Direction>
void expect_unknown_kinds_refused() {
  for (std::size_t kind = std::variant_size_v<Direction>; kind < 256; ++kind) {
    Buffer bytes(64);
    std::memset(bytes.data(), 0, bytes.size());
    bytes.data()[0] = static_cast<std::byte>(kind);
    EXPECT_FALSE(decode<Direction>(std::move(bytes))) << kind;
  }
}

TEST(HostileMessage, OfAnUnknownKindIsRefused) {
  expect_unknown_kinds_refused<ToMaster>();
  expect_unknown_kinds_refused<ToWorker>();
  expect_unknown_kinds_refused<ToCompositor>();
}

TEST(HostileMessage, WithPaddingThatIsNotZeroIsRefused) {
  Buffer bytes = encode(ToCompositor(filled<Samples>()));
  // Kind, epoch, tile, from, to, count, tag.
  const std::size_t padding = 1 + 4 + 4 + 2 + 2 + 4 + (1 + 4);
  ASSERT_EQ(bytes.data()[padding], std::byte{0});
  bytes.data()[padding] = std::byte{1};
  EXPECT_FALSE(decode<ToCompositor>(std::move(bytes)));
}

template <class Enum>
void expect_only_enumerators_read() {
  using Number = std::underlying_type_t<Enum>;
  std::set<int> known;
  for (const Enum value : Enumerators<Enum>::values) known.insert(static_cast<int>(value));
  for (int number = -128; number < 256; ++number) {
    ByteWriter writer;
    writer.write(static_cast<Number>(number));
    Enum value{};
    const bool good = ByteReader(writer.bytes()).read(value);
    EXPECT_EQ(good, known.contains(static_cast<int>(static_cast<Number>(number)))) << number;
    if (good) {
      EXPECT_EQ(value, static_cast<Enum>(number));
    }
  }
}

TEST(HostileMessage, WithAnUnknownEnumeratorIsRefused) {
  expect_only_enumerators_read<Role>();
  expect_only_enumerators_read<VoxelType>();
  expect_only_enumerators_read<ColorSpace>();
  expect_only_enumerators_read<ExitStatus>();
  expect_only_enumerators_read<Sampling>();
  expect_only_enumerators_read<Filter>();
  expect_only_enumerators_read<Update>();
  expect_only_enumerators_read<Coding>();
  expect_only_enumerators_read<Compression>();
}

TEST(HostileMessage, CannotReportAFailureAsDone) {
  EXPECT_FALSE(decode<ToMaster>(encode(ToMaster(RankFailed{{"a", "b", "c", ExitStatus::kDone}}))));
}

TEST(HostileMessage, WithABoolOtherThanZeroAndOneIsRefused) {
  for (int number = 0; number < 256; ++number) {
    const auto byte = static_cast<std::byte>(number);
    bool value = false;
    EXPECT_EQ(ByteReader(std::span(&byte, 1)).read(value), number < 2) << number;
    std::optional<std::uint8_t> maybe;
    const std::array bytes{byte, std::byte{9}};
    EXPECT_EQ(ByteReader(bytes).read(maybe), number < 2) << number;
  }
}

/// What reading a T costs whose count promises `count` elements, of which there are `present`
/// bytes.
template <class T>
void expect_lie_refused(std::uint32_t count, std::size_t present) {
  ByteWriter writer;
  writer.write(count);
  for (std::size_t i = 0; i < present; ++i) writer.write(std::uint8_t{0});
  const std::size_t before = allocated_bytes();
  T value;
  EXPECT_FALSE(ByteReader(writer.bytes()).read(value)) << count << " in " << present;
  // Growth by doubling, times what an element takes in memory of its bytes on the wire.
  EXPECT_LE(allocated_bytes() - before, 64 * (present + 4)) << count << " in " << present;
}

TEST(HostileMessage, WithACountOfMoreThanThereIsIsRefusedWithoutMemory) {
  for (const std::uint32_t count : {101u, 0x10000u, 0x7fffffffu, 0xffffffffu}) {
    for (const std::size_t present : {0u, 1u, 100u}) {
      expect_lie_refused<std::string>(count, present);
      expect_lie_refused<std::vector<std::uint64_t>>(count, present);
      expect_lie_refused<std::vector<std::string>>(count, present);
      expect_lie_refused<std::vector<MessageCount>>(count, present);
    }
  }
  // As many bytes as elements, but not as many as the elements need.
  expect_lie_refused<std::vector<std::uint64_t>>(4096, 4096);
  expect_lie_refused<std::vector<MessageCount>>(4096, 4096);
  expect_lie_refused<std::vector<std::string>>(4096, 4096);
}

template <class Direction, std::size_t Kind>
void mutate(const Buffer& whole, std::mt19937& random) {
  const auto below = [&](std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
  };
  Buffer bytes =
      copy_of(whole.bytes().first(below(4) == 0 ? below(whole.size() + 1) : whole.size()));
  for (std::size_t flips = below(4); flips > 0 && bytes.size() > 1; --flips) {
    constexpr std::array<unsigned, 6> kNasty{0x00, 0x01, 0x7f, 0x80, 0xfe, 0xff};
    bytes.data()[below(bytes.size())] =
        static_cast<std::byte>(below(2) == 0 ? kNasty[below(kNasty.size())] : below(256));
  }
  const std::size_t size = bytes.size();
  const Buffer before = copy_of(bytes.bytes());
  const std::size_t allocated = allocated_bytes();
  auto decoded = decode<Direction>(std::move(bytes));
  ASSERT_LE(allocated_bytes() - allocated, 64 * (size + 16));
  if (!decoded) return;
  // The wire has one form for each value: what was accepted encodes to the same bytes.
  const Buffer again = encode(std::move(*decoded));
  ASSERT_TRUE(same(again, before));
}

TEST(HostileMessage, ChangedAtRandomIsRefusedOrMeansWhatItsBytesSay) {
  std::mt19937 random(20250131);
  for_each_message([&]<class Direction, std::size_t Kind>() {
    SCOPED_TRACE((MessageOf<Direction, Kind>::kName));
    const Buffer whole = encoded<Direction, Kind>();
    for (int i = 0; i < 3000; ++i) {
      mutate<Direction, Kind>(whole, random);
      if (::testing::Test::HasFatalFailure()) return;
    }
  });
}

TEST(HostileMessage, OfRandomBytesIsRefusedOrMeansWhatItsBytesSay) {
  std::mt19937 random(7);
  for (int i = 0; i < 20000; ++i) {
    Buffer bytes(std::uniform_int_distribution<std::size_t>(0, 100)(random));
    for (std::byte& byte : bytes.bytes()) byte = static_cast<std::byte>(random());
    constexpr std::size_t kKinds = std::variant_size_v<ToMaster>;
    if (bytes.size() > 0) bytes.data()[0] = static_cast<std::byte>(random() % (kKinds + 1));
    const Buffer before = copy_of(bytes.bytes());
    if (auto decoded = decode<ToMaster>(std::move(bytes))) {
      ASSERT_TRUE(same(encode(std::move(*decoded)), before));
    }
  }
}

}  // namespace
}  // namespace goldthread
