// SPDX-License-Identifier: Apache-2.0
#include "common/protocol/topology.h"

#include <gtest/gtest.h>

namespace goldthread {
namespace {

TEST(Topology, GivesEachRankOneRoleAndOneIndex) {
  for (int ranks = 3; ranks < 20; ++ranks) {
    for (int compositors = 1; compositors <= ranks - 2; ++compositors) {
      const auto topology = Topology::for_ranks(ranks, compositors);
      ASSERT_TRUE(topology);
      EXPECT_EQ(topology->size(), ranks);
      EXPECT_EQ(topology->role_of({0}), Role::kMaster);
      for (int c = 0; c < compositors; ++c) {
        EXPECT_EQ(topology->role_of(topology->compositor(c)), Role::kCompositor);
        EXPECT_EQ(topology->compositor_index(topology->compositor(c)), c);
      }
      for (int w = 0; w < topology->workers; ++w) {
        EXPECT_EQ(topology->role_of(topology->worker(w)), Role::kWorker);
        EXPECT_EQ(topology->worker_index(topology->worker(w)), w);
      }
      EXPECT_EQ(topology->worker(topology->workers - 1), Rank{ranks - 1});
    }
  }
}

TEST(Topology, OfTooFewRanksSaysHowManyItTakes) {
  for (const int ranks : {1, 2, 3, 4}) {
    const auto topology = Topology::for_ranks(ranks, 3);
    ASSERT_FALSE(topology) << ranks;
    EXPECT_EQ(topology.failure().status, ExitStatus::kUsage);
    EXPECT_NE(topology.failure().mend.find("at least 5 ranks"), std::string::npos);
  }
}

}  // namespace
}  // namespace goldthread
