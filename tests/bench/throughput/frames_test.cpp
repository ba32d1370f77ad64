// SPDX-License-Identifier: Apache-2.0
#include "bench/throughput/frames.h"

#include <gtest/gtest.h>

#include "tests/master/loopback_cluster.h"

namespace goldthread::bench {
namespace {

FramesResult example() {
  FramesResult result;
  result.tiles = 4;
  result.seconds = {0.25, 0.5};
  result.lossless_seconds = {0.75};
  result.master_cpu_seconds = 0.125;
  result.sample_bytes = 1024;
  result.sample_messages = 4;
  result.paced = {60, 2, 1.5, 0.0625};
  return result;
}

TEST(Frames, CountWhatAFrameIsMadeOf) {
  constexpr ImageSize kSize{128, 96};
  test::LoopbackCluster ranks({2, 2}, kSize);
  FramesRequest request;
  request.grid = TileGrid::squares(kSize, 64);
  request.least_frames = 3;
  request.least_time = std::chrono::milliseconds(40);
  const FramesResult result = run_frames(ranks.cluster(), ranks.scene(), request);
  EXPECT_EQ(result.tiles, 4u);
  EXPECT_GE(result.seconds.size(), 3u);
  EXPECT_GE(result.lossless_seconds.size(), 3u);
  for (const double seconds : result.seconds) EXPECT_GT(seconds, 0);
  EXPECT_DOUBLE_EQ(result.sample_messages, 4);
  // A float RGBA for each pixel, and the messages' heads.
  EXPECT_GT(result.sample_bytes, 128 * 96 * 16);
  EXPECT_LT(result.sample_bytes, 128 * 96 * 16 + 4 * 64);
  EXPECT_GT(result.master_cpu_seconds, 0);
  EXPECT_GE(result.paced.frames, 3);
  EXPECT_GE(result.paced.seconds, 0.04);
  EXPECT_GT(result.paced.master_cpu_seconds, 0);
}

TEST(Frames, TilesOfAllFramesCountForTheMastersTime) {
  EXPECT_DOUBLE_EQ(example().tiles_per_master_second(), 3 * 4 / 0.125);
  EXPECT_EQ(FramesResult{}.tiles_per_master_second(), 0);
}

TEST(Frames, ComeBackAsTheyWereWritten) {
  const FramesResult written = example();
  const auto read = parse_frames(frames_json(written), "a file");
  ASSERT_TRUE(read);
  EXPECT_EQ(frames_json(*read), frames_json(written));
  EXPECT_EQ(read->seconds, written.seconds);
  EXPECT_EQ(read->paced.late, 2);
}

TEST(Frames, ThatAreNotThereAreAFailure) {
  for (const char* text : {"", "{}", "[1]", R"({"tiles": "many"})"}) {
    const auto read = parse_frames(text, "frames.json");
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.failure().where, "frames.json");
  }
}

}  // namespace
}  // namespace goldthread::bench
