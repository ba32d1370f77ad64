// SPDX-License-Identifier: Apache-2.0
// `goldthread bench error` as users call it, on a volume of 24³ voxels.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "bench/error/process.h"
#include "small_subject.h"

namespace goldthread::bench {
namespace {

using testing::HasSubstr;

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// Runs the program with its stdout in a file.
std::string output_of(const std::string& arguments, const std::filesystem::path& folder) {
  const auto output = folder / "stdout.txt";
  ChildProcess program({"sh", "-c", GOLDTHREAD_PROGRAM " " + arguments + " > " + output.string()},
                       folder / "stderr.txt");
  program.wait(std::chrono::seconds(100));
  return text_of(output);
}

TEST(BenchProgram, AQuickBenchWithoutPeersWritesItsReport) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "bench_program";
  const auto ball = test::write_ball(folder);
  const auto report_folder = folder / "report";
  const std::string output =
      output_of("bench error " + ball.string() +
                    " --quick --no-peers --size 64x64 --instruction-sets all --threads 2 -o " +
                    report_folder.string(),
                folder);
  EXPECT_THAT(output, HasSubstr("\nGoals\n"));
  EXPECT_THAT(output, HasSubstr("another scene"));
  const auto json = nlohmann::json::parse(text_of(report_folder / "report.json"));
  for (const char* key :
       {"bench",      "version", "date",      "machine",  "instructionSet", "scene",
        "volume",     "size",    "threads",   "repeats",  "stride",         "goals",
        "references", "methods", "latencies", "storages", "features",       "gatherAndLerp",
        "memory",     "peers",   "notes"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["size"], nlohmann::json({64, 64}));
  for (const auto& method : json["methods"]) {
    EXPECT_EQ(method["program"], "Goldthread");
    EXPECT_GT(method["seconds"]["min"], 0);
    EXPECT_EQ(method["rays"], 64 * 64);
  }
  for (const auto& reference : json["references"]) EXPECT_GE(reference["smallestError"], 0);
  EXPECT_THAT(text_of(report_folder / "report.md"), HasSubstr("### Speed against error"));
  EXPECT_TRUE(std::filesystem::exists(report_folder / "error-time.gp"));
}

}  // namespace
}  // namespace goldthread::bench
