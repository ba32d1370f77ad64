// SPDX-License-Identifier: Apache-2.0
#include "common/codec/row_codec.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "tests/common/protocol/allocations.h"

namespace goldthread {
namespace {

using Bytes = std::vector<std::byte>;

template <class Word>
void append(Bytes& bytes, Word word) {
  const auto raw = std::bit_cast<std::array<std::byte, sizeof(Word)>>(word);
  bytes.insert(bytes.end(), raw.begin(), raw.end());
}

/// Colours of a smooth picture, RGBA, then the places of a grid: as Samples have them.
struct Tile {
  std::vector<RowLayout> layouts;
  Bytes raw;
};
Tile smooth_tile(int edge) {
  const auto count = static_cast<std::size_t>(edge * edge);
  Tile tile{{{count, 4, 4}, {count, 2, 2}}, {}};
  for (int y = 0; y < edge; ++y) {
    for (int x = 0; x < edge; ++x) {
      for (int c = 0; c < 4; ++c)
        append(tile.raw, 0.5f + 0.4f * std::sin(0.02f * float(x + c) + 0.03f * float(y)));
    }
  }
  for (int y = 0; y < edge; ++y) {
    for (int x = 0; x < edge; ++x) {
      append(tile.raw, static_cast<std::uint16_t>(x));
      append(tile.raw, static_cast<std::uint16_t>(y));
    }
  }
  return tile;
}

bool equal(std::span<const std::byte> a, std::span<const std::byte> b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
}

TEST(RowCodec, GivesEveryBitBack) {
  RowCodec codec;
  std::mt19937 random(3);
  const std::array nasty{0.0f,
                         -0.0f,
                         std::numeric_limits<float>::infinity(),
                         std::numeric_limits<float>::quiet_NaN(),
                         std::numeric_limits<float>::denorm_min(),
                         -1.0f,
                         std::numeric_limits<float>::lowest()};
  int shorter = 0;
  for (const std::size_t word : {1u, 2u, 4u}) {
    for (const std::size_t channels : {1u, 2u, 3u, 4u, 7u}) {
      for (const std::size_t rows : {1u, 2u, 63u, 64u, 1000u}) {
        const RowLayout layout{rows, channels, word};
        Bytes raw;
        for (std::size_t i = 0; i < layout.bytes(); i += 4) append(raw, nasty[random() % 7]);
        raw.resize(layout.bytes());
        const auto packed = codec.compress(raw, std::span(&layout, 1));
        if (!packed) continue;
        ++shorter;
        EXPECT_LT(packed->size(), raw.size());
        const auto again = codec.decompress(packed->bytes(), std::span(&layout, 1));
        ASSERT_TRUE(again) << word << " " << channels << " " << rows;
        EXPECT_TRUE(equal(again->bytes(), raw)) << word << " " << channels << " " << rows;
      }
    }
  }
  EXPECT_GT(shorter, 30);
}

TEST(RowCodec, MakesSmoothSamplesMuchShorterThanZstdAloneDoes) {
  const Tile tile = smooth_tile(64);
  RowCodec codec;
  const auto packed = codec.compress(tile.raw, tile.layouts);
  ASSERT_TRUE(packed);
  std::vector<std::byte> plain(ZSTD_compressBound(tile.raw.size()));
  const std::size_t alone =
      ZSTD_compress(plain.data(), plain.size(), tile.raw.data(), tile.raw.size(), 1);
  EXPECT_LT(packed->size(), alone * 7 / 10);
  EXPECT_LT(packed->size(), tile.raw.size() / 2);
  const auto again = codec.decompress(packed->bytes(), tile.layouts);
  ASSERT_TRUE(again);
  EXPECT_TRUE(equal(again->bytes(), tile.raw));
}

TEST(RowCodec, LeavesWhatDoesNotBecomeShorter) {
  RowCodec codec;
  std::mt19937 random(5);
  const RowLayout layout{1000, 4, 4};
  Bytes noise(layout.bytes());
  for (std::byte& byte : noise) byte = static_cast<std::byte>(random());
  EXPECT_FALSE(codec.compress(noise, std::span(&layout, 1)));
  EXPECT_FALSE(codec.compress({}, std::span(&layout, 1)));
  EXPECT_FALSE(codec.compress(std::span(noise).first(100), std::span(&layout, 1)));
}

TEST(RowCodec, RefusesAFrameOfAnotherLengthOrCutShort) {
  const Tile tile = smooth_tile(32);
  RowCodec codec;
  const auto packed = codec.compress(tile.raw, tile.layouts);
  ASSERT_TRUE(packed);
  for (std::size_t size = 0; size < packed->size(); ++size)
    ASSERT_FALSE(codec.decompress(packed->bytes().first(size), tile.layouts)) << size;
  auto other = tile.layouts;
  for (const std::size_t rows : {std::size_t{0}, other[0].rows - 1, other[0].rows + 1}) {
    other[0].rows = rows;
    EXPECT_FALSE(codec.decompress(packed->bytes(), other)) << rows;
  }
  EXPECT_FALSE(codec.decompress({}, tile.layouts));
  EXPECT_FALSE(codec.decompress(tile.raw, tile.layouts));
}

TEST(RowCodec, TakesNoMemoryForAPromiseThatCannotBeKept) {
  const Tile tile = smooth_tile(16);
  RowCodec codec;
  const auto packed = codec.compress(tile.raw, tile.layouts);
  ASSERT_TRUE(packed);
  const std::size_t before = allocated_bytes();
  for (const std::size_t rows : {std::size_t{1} << 26, std::size_t{0xffffffff}}) {
    const RowLayout layout{rows, 4, 4};
    EXPECT_FALSE(codec.decompress(packed->bytes(), std::span(&layout, 1)));
  }
  EXPECT_LT(allocated_bytes() - before, 1024u);
}

TEST(RowCodec, SurvivesBytesChangedAtRandom) {
  const Tile tile = smooth_tile(16);
  RowCodec codec;
  const auto packed = codec.compress(tile.raw, tile.layouts);
  ASSERT_TRUE(packed);
  std::mt19937 random(11);
  int refused = 0;
  for (int i = 0; i < 5000; ++i) {
    Bytes bytes(packed->bytes().begin(), packed->bytes().end());
    for (std::size_t flips = 1 + random() % 4; flips > 0; --flips)
      bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    const auto decoded = codec.decompress(bytes, tile.layouts);
    if (!decoded) ++refused;
    // zstd has no checksum here: what it accepts has at least the length that was asked for.
    if (decoded) {
      ASSERT_EQ(decoded->size(), tile.raw.size());
    }
  }
  EXPECT_GT(refused, 0);
  const auto again = codec.decompress(packed->bytes(), tile.layouts);
  ASSERT_TRUE(again);
  EXPECT_TRUE(equal(again->bytes(), tile.raw)) << "after bad frames good ones are as before";
}

}  // namespace
}  // namespace goldthread
