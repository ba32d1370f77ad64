// SPDX-License-Identifier: Apache-2.0
#include "worker/tile_store.h"

#include <gtest/gtest.h>

namespace goldthread {
namespace {

std::unique_ptr<TileRefinement> new_tile(int edge = 64) {
  return std::make_unique<TileRefinement>(TileTask{{0, 0, edge, edge}, {}, {}});
}

/// Room for `count` tiles and not one more.
std::size_t room_for(std::size_t count) {
  const std::size_t each = new_tile()->bytes();
  return count * each + each / 2;
}

TEST(TileStore, GivesBackWhatWasPutThereOnce) {
  TileStore store(room_for(2));
  auto tile = new_tile();
  const TileRefinement* const held = tile.get();
  store.put({7}, std::move(tile));
  EXPECT_EQ(store.size(), 1u);
  EXPECT_EQ(store.take({6}), nullptr);
  EXPECT_EQ(store.take({7}).get(), held);
  EXPECT_EQ(store.take({7}), nullptr);
  EXPECT_EQ(store.size(), 0u);
}

TEST(TileStore, HoldsTheLastOfATileThatIsPutTwice) {
  TileStore store(room_for(2));
  store.put({1}, new_tile());
  auto newer = new_tile();
  const TileRefinement* const held = newer.get();
  store.put({1}, std::move(newer));
  EXPECT_EQ(store.size(), 1u);
  EXPECT_EQ(store.take({1}).get(), held);
}

TEST(TileStore, LetsGoOfThoseThatWereNotUsedForLongest) {
  TileStore store(room_for(3));
  for (std::uint32_t i = 0; i < 3; ++i) store.put({i}, new_tile());
  store.put({0}, store.take({0}));
  store.put({3}, new_tile());
  EXPECT_EQ(store.size(), 3u);
  EXPECT_EQ(store.take({1}), nullptr) << "0 was used since";
  for (const std::uint32_t i : {0u, 2u, 3u}) EXPECT_NE(store.take({i}), nullptr) << i;
}

TEST(TileStore, LetsGoOfAsManyAsALargeTileNeeds) {
  TileStore store(room_for(4));
  for (std::uint32_t i = 0; i < 4; ++i) store.put({i}, new_tile());
  store.put({4}, new_tile(112));  // takes three times as much
  EXPECT_EQ(store.size(), 2u);
  EXPECT_NE(store.take({3}), nullptr);
  EXPECT_NE(store.take({4}), nullptr);
}

TEST(TileStore, NeverHoldsMoreBytesThanItMayButAlwaysTheLastTile) {
  TileStore store(room_for(3));
  for (std::uint32_t i = 0; i < 100; ++i) {
    store.put({i % 7}, new_tile());
    EXPECT_LE(store.size(), 3u);
  }
  TileStore small(1);
  small.put({0}, new_tile());
  small.put({1}, new_tile());
  EXPECT_EQ(small.size(), 1u);
  EXPECT_NE(small.take({1}), nullptr);
}

TEST(TileStore, HasItsRoomBackWhenTilesAreTakenOrCleared) {
  TileStore store(room_for(3));
  for (int round = 0; round < 10; ++round) {
    for (std::uint32_t i = 0; i < 3; ++i) store.put({i}, new_tile());
    EXPECT_EQ(store.size(), 3u) << round;
    if (round % 2 == 0)
      store.clear();
    else
      for (std::uint32_t i = 0; i < 3; ++i) EXPECT_NE(store.take({i}), nullptr);
    EXPECT_EQ(store.size(), 0u);
    EXPECT_EQ(store.take({0}), nullptr);
  }
}

}  // namespace
}  // namespace goldthread
