// SPDX-License-Identifier: Apache-2.0
// Results of frames on their way between processes.

#include <nlohmann/json.hpp>

#include "bench/throughput/frames.h"

namespace goldthread::bench {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string frames_json(const FramesResult& result) {
  const Json json{{"tiles", result.tiles},
                  {"seconds", result.seconds},
                  {"losslessSeconds", result.lossless_seconds},
                  {"masterCpuSeconds", result.master_cpu_seconds},
                  {"sampleBytes", result.sample_bytes},
                  {"sampleMessages", result.sample_messages},
                  {"paced",
                   {{"frames", result.paced.frames},
                    {"late", result.paced.late},
                    {"seconds", result.paced.seconds},
                    {"masterCpuSeconds", result.paced.master_cpu_seconds}}}};
  return json.dump() + "\n";
}

Result<FramesResult> parse_frames(const std::string& json, const std::string& where) {
  try {
    const Json from = Json::parse(json);
    FramesResult result;
    from.at("tiles").get_to(result.tiles);
    from.at("seconds").get_to(result.seconds);
    from.at("losslessSeconds").get_to(result.lossless_seconds);
    from.at("masterCpuSeconds").get_to(result.master_cpu_seconds);
    from.at("sampleBytes").get_to(result.sample_bytes);
    from.at("sampleMessages").get_to(result.sample_messages);
    const Json& paced = from.at("paced");
    paced.at("frames").get_to(result.paced.frames);
    paced.at("late").get_to(result.paced.late);
    paced.at("seconds").get_to(result.paced.seconds);
    paced.at("masterCpuSeconds").get_to(result.paced.master_cpu_seconds);
    return result;
  } catch (const Json::exception& error) {
    return Failure{where, error.what(), "", ExitStatus::kClusterFailed};
  }
}

}  // namespace goldthread::bench
