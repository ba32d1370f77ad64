// SPDX-License-Identifier: Apache-2.0
#include "common/protocol/buffer.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace goldthread {
namespace {

Buffer counting(std::size_t size) {
  Buffer buffer(size);
  for (std::size_t i = 0; i < size; ++i) buffer.data()[i] = static_cast<std::byte>(i);
  return buffer;
}

std::vector<std::byte> header(std::size_t size) { return std::vector(size, std::byte{0xee}); }

void expect_header_then_count(const Buffer& buffer, std::size_t header, std::size_t size) {
  ASSERT_EQ(buffer.size(), header + size);
  for (std::size_t i = 0; i < header; ++i) EXPECT_EQ(buffer.data()[i], std::byte{0xee});
  for (std::size_t i = 0; i < size; ++i) {
    EXPECT_EQ(buffer.data()[header + i], static_cast<std::byte>(i));
  }
}

TEST(Buffer, TakesAHeaderInItsHeadroomWithoutACopy) {
  Buffer buffer = counting(40);
  const std::byte* const before = buffer.data();
  buffer.prepend(header(Buffer::kHeadroom));
  EXPECT_EQ(buffer.data() + Buffer::kHeadroom, before);
  expect_header_then_count(buffer, Buffer::kHeadroom, 40);
}

TEST(Buffer, TakesAHeaderLongerThanItsHeadroom) {
  Buffer buffer = counting(40);
  buffer.prepend(header(Buffer::kHeadroom + 1));
  expect_header_then_count(buffer, Buffer::kHeadroom + 1, 40);
}

TEST(Buffer, TakesAHeaderWithoutAnyHeadroom) {
  Buffer buffer = Buffer::for_receiving(3);
  for (std::size_t i = 0; i < 3; ++i) buffer.data()[i] = static_cast<std::byte>(i);
  buffer.prepend(header(16));
  expect_header_then_count(buffer, 16, 3);
}

TEST(Buffer, ThatIsEmptyTakesAHeader) {
  Buffer buffer;
  buffer.prepend({});
  EXPECT_EQ(buffer.size(), 0u);
  buffer.prepend(header(5));
  expect_header_then_count(buffer, 5, 0);
}

TEST(Buffer, GivesBackTheHeaderThatItTook) {
  Buffer buffer = counting(10);
  buffer.prepend(header(16));
  buffer.drop_front(16);
  expect_header_then_count(buffer, 0, 10);
  buffer.truncate(4);
  expect_header_then_count(buffer, 0, 4);
}

TEST(Buffer, IsAlignedForSimd) {
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(Buffer(1).data()) % 64, 0u);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(Buffer::for_receiving(1).data()) % 64, 0u);
}

TEST(Buffer, ThatWasMovedFromIsEmpty) {
  Buffer buffer = counting(10);
  const Buffer taken = std::move(buffer);
  EXPECT_EQ(buffer.size(), 0u);  // NOLINT(bugprone-use-after-move)
  EXPECT_TRUE(buffer.bytes().empty());
  expect_header_then_count(taken, 0, 10);
  Buffer assigned = counting(3);
  buffer = counting(7);
  assigned = std::move(buffer);
  EXPECT_EQ(buffer.size(), 0u);  // NOLINT(bugprone-use-after-move)
  expect_header_then_count(assigned, 0, 7);
}

TEST(Buffer, ThatIsLentComesBackAsItWasOnceItIsNotUsed) {
  std::vector<Buffer> back;
  const auto give_back = [&](Buffer buffer) { back.push_back(std::move(buffer)); };
  Buffer own(3);
  const std::byte* const memory = own.data();
  for (std::size_t i = 0; i < 3; ++i) own.data()[i] = std::byte(i);
  {
    Buffer lent = Buffer::lent(std::move(own), give_back);
    EXPECT_EQ(lent.data(), memory);
    const std::byte header[]{std::byte{9}, std::byte{9}};
    lent.prepend(header);
    lent.truncate(3);
    Buffer moved = std::move(lent);
    EXPECT_TRUE(back.empty());
  }
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back[0].data(), memory);
  ASSERT_EQ(back[0].size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(back[0].data()[i], std::byte(i));
}

}  // namespace
}  // namespace goldthread
