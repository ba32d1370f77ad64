// SPDX-License-Identifier: Apache-2.0
#include "common/tile/update_pattern.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace goldthread {
namespace {

constexpr Update kUpdates[] = {Update::kAll, Update::kHalf, Update::kQuarter, Update::kFrameless,
                               Update::kWhole};
const std::vector<PixelRect> kRects{{0, 0, 64, 64}, {64, 128, 17, 5}, {0, 4, 1, 1}};

TEST(UpdatePattern, ThePartsTogetherHoldEachPlaceOnce) {
  for (const Update update : kUpdates) {
    for (const PixelRect& rect : kRects) {
      std::set<std::uint32_t> all;
      for (std::uint32_t part = 0; part < parts_of(update); ++part) {
        for (const UpdatePlace& place : places_of(rect, update, part)) {
          EXPECT_TRUE(all.insert(place.index).second);
          EXPECT_EQ(part_of(rect, update, place.index), part);
        }
      }
      EXPECT_EQ(all.size(), update_places(rect, update));
      EXPECT_EQ(*all.rbegin() + 1, all.size());
    }
  }
}

TEST(UpdatePattern, PartsAreAsLargeAsTheirNameSays) {
  const PixelRect rect{0, 0, 64, 64};
  EXPECT_EQ(places_of(rect, Update::kAll, 0).size(), 64u * 64);
  EXPECT_EQ(places_of(rect, Update::kWhole, 0).size(), 64u * 64);
  EXPECT_EQ(places_of(rect, Update::kHalf, 1).size(), 64u * 64 / 2);
  EXPECT_EQ(places_of(rect, Update::kQuarter, 3).size(), 64u * 64 / 4);
  EXPECT_EQ(places_of(rect, Update::kFrameless, 9).size(), 64u * 64 / 16);
}

TEST(UpdatePattern, PixelsAreCastAtTheirCentres) {
  const PixelRect rect{64, 128, 17, 5};
  for (const Update update : {Update::kAll, Update::kHalf, Update::kQuarter}) {
    for (std::uint32_t part = 0; part < parts_of(update); ++part) {
      for (const UpdatePlace& place : places_of(rect, update, part)) {
        EXPECT_EQ(place.position.x, 64.5f + float(place.index % 17));
        EXPECT_EQ(place.position.y, 128.5f + float(place.index / 17));
      }
    }
  }
}

TEST(UpdatePattern, ATileHasTheSamplesThatTheWholePictureHasThere) {
  const PixelRect whole{0, 0, 128, 96}, tile{64, 32, 64, 64};
  for (const Update update : kUpdates) {
    for (std::uint32_t part = 0; part < parts_of(update); ++part) {
      std::set<std::pair<float, float>> in_whole, in_tile;
      for (const UpdatePlace& place : places_of(whole, update, part)) {
        if (place.position.x >= 64 && place.position.y >= 32)
          in_whole.insert({place.position.x, place.position.y});
      }
      for (const UpdatePlace& place : places_of(tile, update, part))
        in_tile.insert({place.position.x, place.position.y});
      EXPECT_EQ(in_tile, in_whole);
    }
  }
}

TEST(UpdatePattern, FramelessSamplesKeepTheirDistanceAlsoAcrossBlocks) {
  const auto& pattern = frameless_pattern();
  ASSERT_EQ(pattern.size(), kFramelessSamples);
  float nearest = kFramelessBlock;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    EXPECT_TRUE(0 <= pattern[i].x && pattern[i].x < kFramelessBlock);
    EXPECT_TRUE(0 <= pattern[i].y && pattern[i].y < kFramelessBlock);
    for (std::size_t j = 0; j < i; ++j) {
      float dx = std::abs(pattern[i].x - pattern[j].x), dy = std::abs(pattern[i].y - pattern[j].y);
      dx = std::min(dx, kFramelessBlock - dx);
      dy = std::min(dy, kFramelessBlock - dy);
      nearest = std::min(nearest, std::hypot(dx, dy));
    }
  }
  // The densest packing of as many has 0.76 pixels; samples at random come within 0.05 of another.
  EXPECT_GT(nearest, 0.45f);
}

TEST(UpdatePattern, BlocksBeginAtDifferentSamples) {
  std::map<std::uint32_t, int> count;
  for (const UpdatePlace& place : places_of({0, 0, 256, 256}, Update::kFrameless, 0))
    ++count[place.index % kFramelessSamples];
  EXPECT_EQ(count.size(), kFramelessSamples);
  for (const auto& [number, blocks] : count) EXPECT_LT(blocks, 3 * 4096 / 32) << number;
}

}  // namespace
}  // namespace goldthread
