// SPDX-License-Identifier: Apache-2.0
#include "common/transport/loopback.h"

#include <gtest/gtest.h>

#include <latch>
#include <stdexcept>
#include <thread>
#include <vector>

namespace goldthread {
namespace {

using namespace std::chrono_literals;

/// Longer than any test may take: a wait that is not ended shows as a time-out of the test.
constexpr auto kForEver = std::chrono::duration_cast<std::chrono::microseconds>(1h);

Buffer numbered(std::uint32_t number) {
  Buffer buffer(sizeof number);
  std::memcpy(buffer.data(), &number, sizeof number);
  return buffer;
}

std::uint32_t number_of(const Envelope& envelope) {
  std::uint32_t number = 0;
  std::memcpy(&number, envelope.message.data(), sizeof number);
  return number;
}

struct Ranks {
  explicit Ranks(int size) {
    const LoopbackNetwork network(size);
    for (int i = 0; i < size; ++i) transports.push_back(network.connect({i}));
  }
  Transport& operator[](std::size_t i) { return *transports[i]; }
  std::vector<std::unique_ptr<Transport>> transports;
};

TEST(Loopback, KnowsItsRankAndSize) {
  Ranks ranks(3);
  EXPECT_EQ(ranks[2].rank(), Rank{2});
  EXPECT_EQ(ranks[2].size(), 3);
  EXPECT_FALSE(ranks[2].receive());
}

TEST(Loopback, DeliversARanksMessagesToItself) {
  Ranks ranks(1);
  ranks[0].send({0}, numbered(7));
  ranks[0].wait(kForEver);
  const auto envelope = ranks[0].receive();
  ASSERT_TRUE(envelope);
  EXPECT_EQ(envelope->from, Rank{0});
  EXPECT_EQ(number_of(*envelope), 7u);
}

TEST(Loopback, HandsTheBytesOverWithoutACopy) {
  Ranks ranks(2);
  Buffer sent = numbered(1);
  const std::byte* const address = sent.data();
  ranks[0].send({1}, std::move(sent));
  EXPECT_EQ(ranks[1].receive()->message.data(), address);
}

TEST(Loopback, KeepsTheOrderBetweenAnyTwoRanks) {
  constexpr std::uint32_t kMessages = 2000;
  constexpr std::size_t kSenders = 3;
  Ranks ranks(kSenders + 1);
  std::vector<std::jthread> senders;
  for (std::size_t s = 1; s <= kSenders; ++s) {
    senders.emplace_back([&ranks, s] {
      for (std::uint32_t i = 0; i < kMessages; ++i) ranks[s].send({0}, numbered(i));
    });
  }
  std::vector<std::uint32_t> next(kSenders + 1, 0);
  for (std::size_t received = 0; received < kSenders * kMessages;) {
    const auto envelope = ranks[0].receive();
    if (!envelope) {
      ranks[0].wait(kForEver);
      continue;
    }
    ++received;
    EXPECT_EQ(number_of(*envelope), next[std::size_t(envelope->from.value)]++);
  }
  EXPECT_FALSE(ranks[0].receive());
}

TEST(Loopback, WaitIsEndedByAMessage) {
  Ranks ranks(2);
  std::latch waiting(1);
  std::jthread sender([&] {
    waiting.wait();
    ranks[1].send({0}, numbered(1));
  });
  waiting.count_down();
  ranks[0].wait(kForEver);
  EXPECT_TRUE(ranks[0].receive());
}

TEST(Loopback, WakeEndsTheNextWaitAndOnlyThatOne) {
  Ranks ranks(1);
  ranks[0].wake();
  ranks[0].wake();
  ranks[0].wait(kForEver);
  const auto begin = std::chrono::steady_clock::now();
  ranks[0].wait(2ms);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, 2ms);
}

TEST(Loopback, WakeFromAnotherThreadEndsAWait) {
  Ranks ranks(1);
  for (int i = 0; i < 200; ++i) {
    std::jthread waker([&] { ranks[0].wake(); });
    ranks[0].wait(kForEver);
  }
}

TEST(Loopback, PingPongLosesNoWakeUp) {
  constexpr std::uint32_t kRounds = 5000;
  Ranks ranks(2);
  const auto next = [](Transport& transport) {
    for (;;) {
      if (auto envelope = transport.receive()) return number_of(*envelope);
      transport.wait(kForEver);
    }
  };
  std::jthread echo([&] {
    for (std::uint32_t i = 0; i < kRounds; ++i) ranks[1].send({0}, numbered(next(ranks[1]) + 1));
  });
  for (std::uint32_t i = 0; i < kRounds; ++i) {
    ranks[0].send({1}, numbered(i));
    ASSERT_EQ(next(ranks[0]), i + 1);
  }
}

TEST(Loopback, RefusesARankThatIsNotThere) {
  Ranks ranks(2);
  EXPECT_THROW(ranks[0].send({2}, numbered(1)), std::out_of_range);
  EXPECT_THROW(ranks[0].send({-1}, numbered(1)), std::out_of_range);
}

}  // namespace
}  // namespace goldthread
