// SPDX-License-Identifier: Apache-2.0
// A compositor between fake peers: what they will have said lies in its mailbox before it begins,
// so that each order of arrival is a test and no clock is needed.

#include "compositor/compositor_role.h"

#include <gtest/gtest.h>

#include <cstring>

#include "common/transport/loopback.h"

namespace goldthread {
namespace {

const TileGrid kGrid = TileGrid::squares({64, 64}, 64);
constexpr Rank kCompositor{1}, kWorker{2};

class CompositorRoleTest : public ::testing::Test {
 protected:
  void begin_session(std::uint32_t compositors = 1) {
    master_.to_compositor(kCompositor, BeginSession{1, false, compositors});
  }
  void begin_view(std::uint32_t epoch, const TileGrid& grid = kGrid) {
    master_.to_compositor(kCompositor, BeginView{{epoch}, 1, {}, grid, {0, 0, 0}, {}});
  }
  /// All samples of a step have the value `red`.
  void send_samples(std::uint32_t epoch, Level from, Level to, float red, std::uint32_t tile = 0) {
    const std::vector<Sample> samples(new_samples({64, 64}, from, to).size(), Sample{red, 0, 0, 1});
    Samples message{{epoch}, {tile}, from, to, Buffer(samples.size() * sizeof(Sample))};
    std::memcpy(message.colors.data(), samples.data(), message.colors.size());
    worker_.to_compositor(kCompositor, std::move(message));
  }
  void collect(std::uint32_t epoch) { master_.to_compositor(kCompositor, CollectBand{{epoch}}); }
  /// Lets the role work through its mailbox.
  void run() {
    master_.to_compositor(kCompositor, Stop{});
    CompositorRole(*transports_[1]).run();
    while (auto message = master_.receive<ToMaster>()) {
      EXPECT_EQ(message->first, kCompositor);
      received_.push_back(std::move(message->second));
    }
  }
  template <class Message>
  std::vector<const Message*> received() const {
    std::vector<const Message*> all;
    for (const ToMaster& message : received_) {
      if (const auto* found = std::get_if<Message>(&message)) all.push_back(found);
    }
    return all;
  }
  static float red_of(const BandPicture& picture) {
    float red = 0;
    std::memcpy(&red, picture.pixels.data(), sizeof red);
    return red;
  }

  const LoopbackNetwork network_{3};
  std::unique_ptr<Transport> transports_[3]{network_.connect({0}), network_.connect({1}),
                                            network_.connect({2})};
  Post master_{*transports_[0]}, worker_{*transports_[2]};
  std::vector<ToMaster> received_;
};

TEST_F(CompositorRoleTest, SaysHelloFirst) {
  run();
  ASSERT_FALSE(received_.empty());
  const auto* hello = std::get_if<Hello>(&received_.front());
  ASSERT_TRUE(hello);
  EXPECT_EQ(hello->role, Role::kCompositor);
  EXPECT_EQ(hello->protocol, kProtocolVersion);
}

TEST_F(CompositorRoleTest, TellsEachLevelOnceAndHandsOverItsBand) {
  begin_session();
  begin_view(1);
  send_samples(1, kNoLevel, {4}, 0.25f);
  send_samples(1, {4}, {3}, 0.25f);
  collect(1);
  run();
  const auto ready = received<BandReady>();
  ASSERT_EQ(ready.size(), 2u);
  EXPECT_EQ(ready[0]->level, Level{4});
  EXPECT_EQ(ready[1]->level, Level{3});
  EXPECT_EQ(ready[1]->squared_error, 0);
  const auto bands = received<BandPicture>();
  ASSERT_EQ(bands.size(), 1u);
  EXPECT_EQ(bands[0]->rect, (PixelRect{0, 0, 64, 64}));
  EXPECT_EQ(bands[0]->pixels.size(), 64u * 64 * 4 * sizeof(float));
  EXPECT_EQ(red_of(*bands[0]), 0.25f);
}

TEST_F(CompositorRoleTest, KeepsAndUsesSamplesThatOvertakeTheirBeginView) {
  begin_session();
  send_samples(1, kNoLevel, {4}, 0.5f);
  begin_view(1);
  collect(1);
  run();
  ASSERT_EQ(received<BandReady>().size(), 1u);
  EXPECT_EQ(red_of(*received<BandPicture>().at(0)), 0.5f);
}

TEST_F(CompositorRoleTest, KeepsSamplesThatOvertakeTheirBeginViewAndTheOneBefore) {
  begin_session();
  send_samples(2, kNoLevel, {4}, 0.5f);
  begin_view(1);
  begin_view(2);
  collect(2);
  run();
  const auto ready = received<BandReady>();
  ASSERT_EQ(ready.size(), 1u);
  EXPECT_EQ(ready[0]->epoch, Epoch{2});
  EXPECT_EQ(red_of(*received<BandPicture>().at(0)), 0.5f);
}

TEST_F(CompositorRoleTest, DropsEarlySamplesOfViewsThatNewerOnesReplace) {
  begin_session();
  send_samples(1, kNoLevel, {4}, 0.1f);
  send_samples(2, kNoLevel, {4}, 0.2f);
  send_samples(1, {4}, {3}, 0.1f);
  begin_view(1);
  begin_view(2);
  run();
  const auto ready = received<BandReady>();
  ASSERT_EQ(ready.size(), 1u);
  EXPECT_EQ(ready[0]->epoch, Epoch{2});
}

TEST_F(CompositorRoleTest, DropsStaleSamplesAndRequests) {
  begin_session();
  begin_view(1);
  begin_view(2);
  send_samples(1, kNoLevel, {4}, 0.5f);
  collect(1);
  master_.to_compositor(kCompositor, Present{{1}, 1, 0, 0, false, false});
  run();
  EXPECT_TRUE(received<BandReady>().empty());
  EXPECT_TRUE(received<BandPicture>().empty());
  EXPECT_TRUE(received<RankFailed>().empty());
}

TEST_F(CompositorRoleTest, AnswersSamplesThatDoNotFitWithRankFailedAndServesOn) {
  begin_session();
  begin_view(1);
  send_samples(1, kNoLevel, {4}, 0.5f, 77);
  Samples odd{{1}, {0}, kNoLevel, {4}, Buffer(25 * sizeof(Sample) + 1)};
  std::memset(odd.colors.data(), 0, odd.colors.size());
  worker_.to_compositor(kCompositor, std::move(odd));
  send_samples(1, kNoLevel, {4}, 0.5f);
  run();
  ASSERT_EQ(received<RankFailed>().size(), 2u);
  EXPECT_EQ(received<RankFailed>()[0]->failure.status, ExitStatus::kClusterFailed);
  EXPECT_EQ(received<BandReady>().size(), 1u);
}

TEST_F(CompositorRoleTest, AnswersAViewOrSessionThatIsNoneWithRankFailed) {
  begin_session(0);
  begin_session();
  begin_view(1, {{0, 0}, {64, 64}});
  begin_view(2, {{64, 64}, {24, 64}});
  run();
  EXPECT_EQ(received<RankFailed>().size(), 3u);
}

TEST_F(CompositorRoleTest, AnswersBytesThatAreNoMessageWithRankFailed) {
  Buffer garbage(3);
  std::memset(garbage.data(), 0xff, garbage.size());
  transports_[2]->send(kCompositor, std::move(garbage));
  run();
  ASSERT_EQ(received<RankFailed>().size(), 1u);
  EXPECT_EQ(received<RankFailed>()[0]->failure.where, "rank 2");
}

TEST_F(CompositorRoleTest, AnswersAGatewayThatCannotOpenWithRankFailed) {
  begin_session();
  master_.to_compositor(kCompositor, OpenGateway{"no such address", 0, "token"});
  run();
  EXPECT_EQ(received<RankFailed>().size(), 1u);
  EXPECT_TRUE(received<GatewayOpened>().empty());
}

TEST_F(CompositorRoleTest, CountsWhatItSent) {
  begin_session();
  begin_view(1);
  send_samples(1, kNoLevel, {4}, 0.5f);
  master_.to_compositor(kCompositor, ReportCounters{});
  run();
  ASSERT_EQ(received<Counters>().size(), 1u);
  const Counters& counters = *received<Counters>()[0];
  EXPECT_GT(counters.busy_seconds, 0);
  ASSERT_EQ(counters.sent.size(), 2u);
  EXPECT_EQ(counters.sent[0].kind, "BandReady");
  EXPECT_EQ(counters.sent[1].kind, "Hello");
}

}  // namespace
}  // namespace goldthread
