// SPDX-License-Identifier: Apache-2.0
#include "bench/throughput/ranks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/error/process.h"

namespace goldthread::bench {
namespace {

std::string line_of(const RanksSetup& setup, const std::string& scene = {}, bool quick = false) {
  std::string line;
  for (const std::string& word : command_of(setup, "frames", "/goldthread", "/dir", scene, quick))
    line += word + " ";
  return line;
}

TEST(Ranks, AreStartedWithMpirunOrAsOneProcess) {
  RanksSetup setup;
  setup.size = {256, 128};
  setup.workers = 4;
  setup.tile_px = 32;
  setup.bypass = "worker,compositor";
  constexpr const char* kCommand =
      "/goldthread bench frames --size 256x128 --tile 32 --compositors 1 --threads 1 --bypass "
      "worker,compositor --log-level error -o /dir ";
  EXPECT_THAT(line_of(setup), testing::HasSubstr(std::string("-n 6 ") + kCommand));
  EXPECT_THAT(line_of(setup), testing::HasSubstr("OMPI_MCA_btl=self,vader "));
  setup.carrier = Carrier::kTcp;
  EXPECT_THAT(line_of(setup), testing::HasSubstr("OMPI_MCA_btl=self,tcp "));
  setup.carrier = Carrier::kThreads;
  EXPECT_EQ(line_of(setup), std::string(kCommand) + "--workers 4 ");
}

TEST(Ranks, AreToldTheSceneAndToBeQuick) {
  RanksSetup setup;
  setup.carrier = Carrier::kThreads;
  EXPECT_THAT(line_of(setup, "scene.json"), testing::HasSubstr("bench frames scene.json --size"));
  EXPECT_THAT(line_of(setup, "", true), testing::EndsWith("--quick "));
  EXPECT_THAT(line_of(setup), testing::HasSubstr("--bypass none "));
}

TEST(Ranks, ThatLeaveNoResultFail) {
  const std::filesystem::path folder = testing::TempDir();
  const RanksStarter starter({"true", folder / "ranks", "", true});
  RanksSetup setup;
  setup.carrier = Carrier::kThreads;
  EXPECT_THROW(starter.frames(setup), PeerFailure);
  const RanksStarter failing({"false", folder / "ranks", "", true});
  EXPECT_THROW(failing.frames(setup), PeerFailure);
}

TEST(Stream, IsAsQuickAsItsMedianRound) {
  StreamResult result;
  EXPECT_EQ(result.bytes_per_second(), 0);
  result = {600, {3, 1, 2}};
  EXPECT_DOUBLE_EQ(result.bytes_per_second(), 300);
  const auto read = parse_stream(stream_json(result), "a file");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->seconds, result.seconds);
  EXPECT_FALSE(parse_stream("", "a file"));
}

}  // namespace
}  // namespace goldthread::bench
