// SPDX-License-Identifier: Apache-2.0
#include "common/transport/post.h"

#include <gtest/gtest.h>

#include <new>

#include "common/transport/loopback.h"

namespace goldthread {
namespace {

class PostTest : public ::testing::Test {
 protected:
  const LoopbackNetwork network_{3};
  std::unique_ptr<Transport> transports_[3]{network_.connect({0}), network_.connect({1}),
                                            network_.connect({2})};
  Post master_{*transports_[0]}, compositor_{*transports_[1]}, worker_{*transports_[2]};
};

TEST_F(PostTest, DeliversTypedMessagesInEachDirection) {
  worker_.to_master(LoadProgress{0.5f});
  master_.to_worker({2}, CommitScene{3, "{}"});
  worker_.to_compositor({1}, Reply{4, "x"});
  EXPECT_EQ(std::get<LoadProgress>(master_.receive<ToMaster>()->second).fraction, 0.5f);
  EXPECT_EQ(std::get<CommitScene>(worker_.receive<ToWorker>()->second).revision, 3u);
  const auto reply = compositor_.receive<ToCompositor>();
  EXPECT_EQ(reply->first, Rank{2});
  EXPECT_EQ(std::get<Reply>(reply->second).json, "x");
  EXPECT_FALSE(compositor_.receive<ToCompositor>());
}

TEST_F(PostTest, CountsMessagesAndBytesByKind) {
  EXPECT_TRUE(master_.sent().empty());
  master_.to_worker({2}, CommitScene{1, "abc"});
  master_.to_worker({2}, CommitScene{1, "abcde"});
  master_.to_compositor({1}, CollectBand{});
  std::size_t bytes = 0;
  while (const auto envelope = transports_[2]->receive()) bytes += envelope->message.size();
  const auto counts = master_.sent();
  ASSERT_EQ(counts.size(), 2u);
  EXPECT_EQ(counts[0].kind, "CollectBand");
  EXPECT_EQ(counts[0].messages, 1u);
  EXPECT_EQ(counts[0].bytes, 6u);
  EXPECT_EQ(counts[1].kind, "CommitScene");
  EXPECT_EQ(counts[1].messages, 2u);
  EXPECT_EQ(counts[1].bytes, bytes);
}

TEST_F(PostTest, EndsTheJobOverBytesThatAreNoMessageNamingTheSender) {
  transports_[2]->send({0}, Buffer(0));
  try {
    master_.receive<ToMaster>();
    FAIL() << "accepted";
  } catch (const FatalError& error) {
    EXPECT_EQ(error.failure().where, "rank 2");
    EXPECT_EQ(error.failure().status, ExitStatus::kClusterFailed);
  }
}

TEST_F(PostTest, TellsTheMasterOfAFailureAsItIs) {
  const Failure failure{"file.nii", "is not there", "look elsewhere", ExitStatus::kBadInput};
  worker_.tell_failure(FatalError(failure));
  EXPECT_EQ(std::get<RankFailed>(master_.receive<ToMaster>()->second).failure.line(),
            failure.line());
}

TEST_F(PostTest, TellsTheMasterOfAnyExceptionNamingTheRank) {
  worker_.tell_failure(std::bad_alloc());
  const auto told = std::get<RankFailed>(master_.receive<ToMaster>()->second).failure;
  EXPECT_EQ(told.where, "rank 2");
  EXPECT_EQ(told.status, ExitStatus::kClusterFailed);
}

}  // namespace
}  // namespace goldthread
