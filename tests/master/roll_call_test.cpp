// SPDX-License-Identifier: Apache-2.0
// The end of a job: who is there, and who has been cut off without anybody's having missed it yet.
#include <gtest/gtest.h>

#include <thread>

#include "common/transport/loopback.h"
#include "common/transport/post.h"
#include "master/cluster.h"

namespace goldthread {
namespace {

using namespace std::chrono_literals;

/// A compositor and two workers that say no more than a test has them say.
class RollCall : public testing::Test {
 protected:
  RollCall() {
    for (int i = 1; i < kTopology.size(); ++i) {
      Hello hello;
      hello.build = GOLDTHREAD_VERSION;
      hello.role = kTopology.role_of({i});
      post(i).to_master(hello);
    }
    cluster_.greet();
  }
  std::vector<std::unique_ptr<Transport>> connected() const {
    std::vector<std::unique_ptr<Transport>> made;
    for (int i = 0; i < kTopology.size(); ++i) made.push_back(network_.connect({i}));
    return made;
  }
  std::vector<Post> posts() const {
    std::vector<Post> made;
    for (const auto& transport : transports_) made.emplace_back(*transport);
    return made;
  }
  Post& post(int rank) { return posts_.at(static_cast<std::size_t>(rank)); }
  /// Who is lost in the end, where these ranks answer.
  std::vector<bool> lost(const std::vector<int>& present) {
    {
      const std::jthread answering([&] {
        for (const int rank : present) answer(rank);
      });
      cluster_.call_roll(kPatience);
    }
    std::vector<bool> lost;
    for (const RankState& rank : cluster_.ranks()) lost.push_back(rank.lost);
    return lost;
  }
  void answer(int rank) {
    if (kTopology.role_of({rank}) == Role::kWorker)
      answer_in<ToWorker>(post(rank));
    else
      answer_in<ToCompositor>(post(rank));
  }
  template <class Inbox>
  static void answer_in(Post& rank) {
    for (;;) {
      const auto message = rank.receive<Inbox>();
      if (!message) {
        rank.wait(1ms);
        continue;
      }
      const auto* question = std::get_if<ReportCounters>(&message->second);
      if (question == nullptr) continue;
      Counters counters;
      counters.activity = Activity{};
      counters.activity->asked_us = question->asked_us;
      rank.to_master(counters);
      return;
    }
  }
  /// What a rank is told of the others when the job ends.
  template <class Inbox>
  bool told_of_loss(int rank) {
    while (auto message = post(rank).receive<Inbox>())
      if (const auto* stop = std::get_if<Stop>(&message->second)) return stop->ranks_lost;
    ADD_FAILURE() << "rank " << rank << " was not told to stop";
    return false;
  }

  static constexpr Topology kTopology{1, 2};
  static constexpr auto kPatience = 1s;
  LoopbackNetwork network_{kTopology.size()};
  std::vector<std::unique_ptr<Transport>> transports_ = connected();
  std::vector<Post> posts_ = posts();
  Cluster cluster_{*transports_[0], kTopology, ClusterOptions{1, false}};
};

TEST_F(RollCall, WhereAllAnswerNobodyIsLost) {
  EXPECT_EQ(lost({1, 2, 3}), std::vector<bool>(4, false));
  EXPECT_TRUE(cluster_.stop());
  EXPECT_FALSE(told_of_loss<ToCompositor>(1));
  EXPECT_FALSE(told_of_loss<ToWorker>(3));
}

TEST_F(RollCall, WhoDoesNotAnswerIsLostAndAllAreTold) {
  post(3).to_master(Heartbeat{});
  EXPECT_EQ(lost({1, 2}), (std::vector<bool>{false, false, false, true}));
  EXPECT_FALSE(cluster_.stop());
  EXPECT_TRUE(told_of_loss<ToCompositor>(1));
  EXPECT_TRUE(told_of_loss<ToWorker>(2));
  EXPECT_TRUE(told_of_loss<ToWorker>(3)) << "who was only late has to end, too";
}

TEST_F(RollCall, AnAnswerToAnEarlierQuestionIsNone) {
  post(3).to_master(Counters{});
  Counters earlier;
  earlier.activity = Activity{};
  post(3).to_master(earlier);
  EXPECT_EQ(lost({1, 2}), (std::vector<bool>{false, false, false, true}));
}

TEST_F(RollCall, AFailureAfterTheWorkIsDoneChangesNothing) {
  post(3).to_master(RankFailed{});
  EXPECT_EQ(lost({1, 2, 3}), std::vector<bool>(4, false));
}

TEST(Greeting, ARankThatTakesItselfForAnotherRoleEndsTheJob) {
  constexpr Topology kTopology{2, 1};
  const LoopbackNetwork network(kTopology.size());
  std::vector<std::unique_ptr<Transport>> transports;
  for (int i = 0; i < kTopology.size(); ++i) transports.push_back(network.connect({i}));
  Cluster cluster(*transports[0], kTopology, ClusterOptions{1, false});
  Hello hello;
  hello.build = GOLDTHREAD_VERSION;
  hello.role = Role::kWorker;
  hello.host = "far";
  Post(*transports[2]).to_master(hello);
  try {
    cluster.greet();
    FAIL() << "a worker where a compositor belongs";
  } catch (const FatalError& error) {
    EXPECT_EQ(error.failure().where, "rank 2 on far");
  }
}

}  // namespace
}  // namespace goldthread
