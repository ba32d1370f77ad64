// SPDX-License-Identifier: Apache-2.0
#include "common/codec/bulk_link.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>
#include <vector>

namespace goldthread {
namespace {

constexpr std::size_t kCount = 4096;
RowCodec codec;
const auto kLayout = samples_layout(kCount, true);

/// Samples of a smooth picture with the places of a row.
Buffer payload() {
  Buffer bytes(kCount * (4 * sizeof(float) + 2 * sizeof(std::uint16_t)));
  for (std::size_t i = 0; i < 4 * kCount; ++i) {
    const float value = 0.5f + 0.25f * std::sin(1e-4f * float(i));
    std::memcpy(bytes.data() + 4 * i, &value, 4);
  }
  for (std::size_t i = 0; i < 2 * kCount; ++i) {
    const auto place = static_cast<std::uint16_t>(i / 2);
    std::memcpy(bytes.data() + 16 * kCount + 2 * i, &place, 2);
  }
  return bytes;
}

bool same(const Buffer& a, const Buffer& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size()) == 0;
}

/// Answers all probes as a link of this rate would.
void measure(BulkLink& link, double bytes_per_second) {
  for (int train = 0; train < 8; ++train) {
    std::vector<std::uint32_t> receipts;
    std::size_t bytes = 0;
    const auto begin = std::chrono::steady_clock::now();
    while (const auto probe = link.probe()) {
      bytes += probe->payload.size();
      if (probe->tag.receipt != 0) receipts.push_back(probe->tag.receipt);
    }
    if (receipts.empty()) break;
    std::this_thread::sleep_until(
        begin + std::chrono::duration_cast<std::chrono::nanoseconds>(
                    std::chrono::duration<double>(double(bytes) / bytes_per_second)));
    for (const std::uint32_t receipt : receipts) link.received({receipt});
  }
}

TEST(BulkLink, OnCompressesAndWhatArrivesIsTheSame) {
  BulkLink link({1}, Compression::kOn, {});
  EXPECT_FALSE(link.probe());
  Buffer sent = payload();
  const BulkTag tag = link.pack(codec, sent, kLayout);
  EXPECT_EQ(tag.coding, Coding::kRows);
  EXPECT_EQ(tag.receipt, 0u);
  EXPECT_LT(sent.size(), payload().size());
  ASSERT_TRUE(unpack_bulk(codec, tag, kLayout, sent));
  EXPECT_TRUE(same(sent, payload()));
  const LinkCount count = link.count();
  EXPECT_EQ(count.messages, 1u);
  EXPECT_EQ(count.coded, 1u);
  EXPECT_EQ(count.raw_bytes, payload().size());
  EXPECT_LT(count.sent_bytes, count.raw_bytes);
  EXPECT_GT(count.ratio, 0);
  EXPECT_GT(count.compress_per_s, 0);
  EXPECT_GT(count.decompress_per_s, 0);
}

TEST(BulkLink, OffTouchesNothingAndAsksForNothing) {
  BulkLink link({1}, Compression::kOff, {});
  EXPECT_FALSE(link.probe());
  Buffer sent = payload();
  const BulkTag tag = link.pack(codec, sent, kLayout);
  EXPECT_EQ(tag.coding, Coding::kRaw);
  EXPECT_EQ(tag.receipt, 0u);
  EXPECT_TRUE(same(sent, payload()));
  ASSERT_TRUE(unpack_bulk(codec, tag, kLayout, sent));
  EXPECT_TRUE(same(sent, payload()));
  EXPECT_EQ(link.count().ratio, 0);
}

TEST(BulkLink, AutoIsRawUntilTheLinkIsKnownAndThenGoesByIt) {
  BulkLink slow({1}, Compression::kAuto, {}), fast({2}, Compression::kAuto, {});
  for (BulkLink* link : {&slow, &fast}) {
    Buffer first = payload();
    const BulkTag tag = link->pack(codec, first, kLayout);
    EXPECT_EQ(tag.coding, Coding::kRaw);
    link->received({tag.receipt});
  }
  measure(slow, 50e6);
  measure(fast, 50e9);
  EXPECT_LT(slow.count().bytes_per_second, 51e6);
  EXPECT_GT(fast.count().bytes_per_second, 1e9);
  Buffer to_slow = payload(), to_fast = payload();
  EXPECT_EQ(slow.pack(codec, to_slow, kLayout).coding, Coding::kRows);
  EXPECT_EQ(fast.pack(codec, to_fast, kLayout).coding, Coding::kRaw);
  EXPECT_TRUE(same(to_fast, payload()));
}

TEST(BulkLink, ProbesEndAndAreNotPiledUp) {
  BulkLink link({1}, Compression::kAuto, {});
  int pieces = 0;
  while (link.probe()) ++pieces;
  EXPECT_EQ(pieces, 8) << "the next ones when these have arrived";
  measure(link, 1e9);
  EXPECT_FALSE(link.probe());
}

TEST(BulkLink, ASlowLinkIsNotProbedTwice) {
  BulkLink link({1}, Compression::kAuto, {});
  const auto begin = std::chrono::steady_clock::now();
  std::vector<std::uint32_t> receipts;
  while (const auto probe = link.probe()) receipts.push_back(probe->tag.receipt);
  std::this_thread::sleep_until(begin + std::chrono::milliseconds(600));
  for (const std::uint32_t receipt : receipts) link.received({receipt});
  EXPECT_GT(link.count().bytes_per_second, 0);
  EXPECT_FALSE(link.probe());
}

TEST(BulkLink, LittleIsSentAsItIs) {
  BulkLink link({1}, Compression::kOn, {});
  const auto layout = samples_layout(4, true);
  Buffer little(layout[0].bytes() + layout[1].bytes());
  std::memset(little.data(), 0, little.size());
  EXPECT_EQ(link.pack(codec, little, layout).coding, Coding::kRaw);
}

TEST(BulkLink, APayloadThatIsNotWhatItsTagSaysIsRefused) {
  Buffer raw = payload();
  EXPECT_FALSE(unpack_bulk(codec, {Coding::kRows, 0}, kLayout, raw));
}

}  // namespace
}  // namespace goldthread
