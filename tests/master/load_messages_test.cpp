// SPDX-License-Identifier: Apache-2.0
#include "master/load_messages.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "loopback_cluster.h"

namespace goldthread {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

constexpr Topology kTopology{2, 3};
constexpr ImageSize kImage{160, 96};

TEST(LoadMessages, TheLastSecondIsTheNewestTwentyBins) {
  EXPECT_EQ(busy_in_last_second({}), 0);
  std::vector<std::uint8_t> share(128, 255);
  EXPECT_DOUBLE_EQ(busy_in_last_second(share), 1);
  std::fill(share.end() - 20, share.end() - 10, 0);
  EXPECT_DOUBLE_EQ(busy_in_last_second(share), 0.5);
  std::fill(share.end() - 10, share.end(), 0);
  EXPECT_DOUBLE_EQ(busy_in_last_second(share), 0);
}

TEST(LoadMessages, TilesAreTheirRectangleOwnerAndMilliseconds) {
  ViewState view;
  view.epoch = {7};
  view.grid = TileGrid::squares({100, 64}, 64);
  view.tiles = {{{3}, 1.25e-3, {}}, {{2}, 0.5, {}}};
  EXPECT_EQ(Json::parse(tiles_message(view)),
            Json::parse(R"({"type":"tiles","epoch":7,"width":100,"height":64,"tile":[64,64],
                            "tiles":[0,0,64,64,3,1.25, 64,0,36,64,2,500.0]})"));
}

/// A cluster of threads that casts the ball, told about as a session would.
class LoadTellerTest : public testing::Test {
 protected:
  /// Casts a step of a new view.
  void cast() {
    cluster().begin_view(ranks_.scene(), {TileGrid::squares(kImage, 32), {}});
    while (cluster().view().held == kNoStep) cluster().poll(5ms);
  }
  /// Lets the teller go on until it has told `count` messages, or for `at_most`.
  std::vector<Json> told(std::size_t count, std::chrono::milliseconds at_most = 20s) {
    std::vector<Json> messages;
    const auto end = Clock::now() + at_most;
    while (messages.size() < count && Clock::now() < end) {
      cluster().poll(1ms);
      teller_.tell(cluster(), Clock::now(),
                   [&](const std::string& json) { messages.push_back(Json::parse(json)); });
    }
    return messages;
  }
  std::uint64_t requests() {
    for (const MessageCount& count : cluster().post().sent())
      if (count.kind == "ReportCounters") return count.messages;
    return 0;
  }
  Cluster& cluster() { return ranks_.cluster(); }

  test::LoopbackCluster ranks_{kTopology, kImage};
  LoadTeller teller_;
};

TEST_F(LoadTellerTest, NobodyWatchesNothingIsAskedOrTold) {
  cast();
  EXPECT_TRUE(told(1, 600ms).empty());
  EXPECT_EQ(requests(), 0U);
  teller_.watch(true, true);
  teller_.watch(false, false);
  EXPECT_TRUE(told(1, 600ms).empty());
  EXPECT_EQ(requests(), 0U);
}

TEST_F(LoadTellerTest, TheLoadHasEachRankAndTheBytesThatTheyCounted) {
  cast();
  teller_.watch(true, false);
  const Json load = told(1).at(0);
  EXPECT_EQ(load.at("type"), "load");
  EXPECT_EQ(load.at("bin"), 50);
  ASSERT_EQ(load.at("ranks").size(), 6U);
  double thread_seconds = 0;
  for (int i = 0; i < 6; ++i) {
    const Json& rank = load.at("ranks").at(static_cast<std::size_t>(i));
    EXPECT_EQ(rank.at("rank"), i);
    EXPECT_EQ(rank.at("role"), i == 0 ? "master" : i < 3 ? "compositor" : "worker");
    EXPECT_EQ(rank.at("share").get<std::string>().size(), 128U);
    EXPECT_EQ(rank.contains("view"), i >= 3);
    if (i >= 3) thread_seconds += rank.at("view").get<double>();
    EXPECT_GE(rank.at("age"), -0.001) << "of this machine's one clock";
    EXPECT_LT(rank.at("age"), 1000.0);
    EXPECT_LT(rank.at("error"), 1000.0);
  }
  double tile_seconds = 0;
  for (const ViewState::Tile& tile : cluster().whole_view().tiles) tile_seconds += tile.seconds;
  EXPECT_GT(tile_seconds, 0);
  EXPECT_NEAR(thread_seconds, tile_seconds, 3e-6) << "each worker has one thread";
  const auto traffic = traffic_of(cluster().ranks());
  ASSERT_EQ(load.at("bytes").size(), traffic.size());
  for (const Json& entry : load.at("bytes"))
    EXPECT_EQ(entry.at("total"), traffic.at(entry.at("kind")).bytes);
  EXPECT_GT(traffic.at("Samples").bytes, 0U);
}

TEST_F(LoadTellerTest, TheLoadIsToldAFewTimesASecondWithOneRequestEach) {
  cast();
  teller_.watch(true, false);
  const auto begin = Clock::now();
  EXPECT_EQ(told(3).size(), 3U);
  EXPECT_GE(Clock::now() - begin, 2 * LoadTeller::kInterval);
  EXPECT_EQ(requests(), 3U * 5U);
}

TEST_F(LoadTellerTest, TilesOfAWholeViewAreToldOnceUntilTheyChangeOrASecondHasPassed) {
  teller_.watch(false, true);
  EXPECT_TRUE(told(1, 400ms).empty()) << "there is no view";
  cast();
  const Json tiles = told(1).at(0);
  EXPECT_EQ(tiles.at("type"), "tiles");
  EXPECT_EQ(tiles.at("epoch"), cluster().view().epoch.value);
  ASSERT_EQ(tiles.at("tiles").size(), 6U * 15U);
  for (std::size_t i = 0; i < 15; ++i) {
    EXPECT_GE(tiles.at("tiles").at(6 * i + 4), 3) << "a worker's rank";
    EXPECT_LE(tiles.at("tiles").at(6 * i + 4), 5);
  }
  EXPECT_EQ(requests(), 0U) << "the ranks have nothing to add";
  const auto begin = Clock::now();
  EXPECT_EQ(told(1).size(), 1U);
  EXPECT_GE(Clock::now() - begin, LoadTeller::kRepeat - 100ms);
  cast();
  EXPECT_EQ(told(1, 900ms).at(0).at("epoch"), cluster().view().epoch.value);
}

TEST_F(LoadTellerTest, AViewThatHasJustBegunDoesNotHideTheWholeOneBeforeIt) {
  cast();
  const Epoch whole = cluster().view().epoch;
  cluster().begin_view(ranks_.scene(), {TileGrid::squares(kImage, 32), {}});
  EXPECT_EQ(cluster().whole_view().epoch, whole);
  EXPECT_EQ(cluster().whole_view().tiles.size(), 15U);
  while (cluster().view().held == kNoStep) cluster().poll(5ms);
  EXPECT_GT(cluster().whole_view().epoch, whole);
}

}  // namespace
}  // namespace goldthread
