// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/message_file.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace goldthread::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostTimes = 1000;
constexpr std::size_t kMostName = 200;

/// Finite and not negative.
bool is_time(const Json& time, const char* field, double& value) {
  const auto found = time.find(field);
  if (found == time.end() || !found->is_number()) return false;
  value = found->get<double>();
  return std::isfinite(value) && value >= 0;
}

}  // namespace

std::string link_json(const MeasuredLink& link) {
  Json times = Json::array();
  for (const MessageTime& time : link.times)
    times.push_back({{"bytes", time.bytes},
                     {"sendUs", time.send_us},
                     {"receiveUs", time.receive_us},
                     {"transitUs", time.transit_us}});
  return Json{{"ranks", link.name}, {"times", times}}.dump(
             1, ' ', false, nlohmann::json::error_handler_t::replace) +
         "\n";
}

Result<MeasuredLink> read_link(const std::string& text, const std::string& where) {
  const Failure bad{where, "holds no measured messages",
                    "delete it, or have two MPI ranks of goldthread bench scale write it",
                    ExitStatus::kBadInput};
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("ranks") || !json["ranks"].is_string() ||
      !json.contains("times") || !json["times"].is_array() || json["times"].empty() ||
      json["times"].size() > kMostTimes)
    return bad;
  MeasuredLink link{json["ranks"].get<std::string>().substr(0, kMostName), {}};
  for (const Json& each : json["times"]) {
    MessageTime time;
    if (!each.is_object() || !is_time(each, "bytes", time.bytes) ||
        !is_time(each, "sendUs", time.send_us) || !is_time(each, "receiveUs", time.receive_us) ||
        !is_time(each, "transitUs", time.transit_us))
      return bad;
    link.times.push_back(time);
  }
  return link;
}

}  // namespace goldthread::bench
