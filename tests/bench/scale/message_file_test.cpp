// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/message_file.h"

#include <gtest/gtest.h>

namespace goldthread::bench {
namespace {

TEST(MessageFile, IsReadAsItWasWritten) {
  const MeasuredLink link{"MPI", {{64, 1.5, 2.5, 30}, {1024, 1.75, 2.25, 0}}};
  const auto read = read_link(link_json(link), "messages.json");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->name, "MPI");
  ASSERT_EQ(read->times.size(), 2U);
  EXPECT_EQ(read->times[0].send_us, 1.5);
  EXPECT_EQ(read->times[1].bytes, 1024);
  EXPECT_EQ(read->times[1].receive_us, 2.25);
  EXPECT_EQ(read->times[0].transit_us, 30);
}

TEST(MessageFile, OfOtherThingsIsRefused) {
  for (
      const char* text :
      {"", "{", "[]", "{}", R"({"ranks": 1, "times": []})", R"({"ranks": "x", "times": []})",
       R"({"ranks": "x", "times": [1]})", R"({"ranks": "x", "times": [{"bytes": 1}]})",
       R"({"ranks": "x", "times": [{"bytes": 1, "sendUs": -1, "receiveUs": 1, "transitUs": 1}]})",
       R"({"ranks": "x", "times": [{"bytes": "1", "sendUs": 1, "receiveUs": 1, "transitUs": 1}]})"}) {
    const auto read = read_link(text, "messages.json");
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.failure().where, "messages.json");
  }
}

}  // namespace
}  // namespace goldthread::bench
