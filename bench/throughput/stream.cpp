// SPDX-License-Identifier: Apache-2.0
#include "bench/throughput/stream.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "bench/error/statistics.h"
#include "common/protocol/wire.h"
#include "common/tile/update_pattern.h"
#include "common/transport/mpi_stream.h"

namespace goldthread::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kRoundBytes = 256e6, kQuickRoundBytes = 64e6;
constexpr int kRounds = 9, kQuickRounds = 3;

/// The message of the first tile's samples: header and colours.
std::size_t message_bytes(const TileGrid& grid) {
  const auto count = places_of(grid.rect({0}), Update::kWhole, 0).size();
  Samples message;
  message.count = static_cast<std::uint32_t>(count);
  message.packed = Buffer(count * sizeof(Sample));
  return encode(ToCompositor(std::move(message))).size();
}

}  // namespace

double StreamResult::bytes_per_second() const {
  return seconds.empty() ? 0 : bytes / median(seconds);
}

StreamResult run_stream(const TileGrid& grid, int compositors, bool quick) {
  MpiStream stream;
  stream.receivers = compositors;
  stream.message_bytes = message_bytes(grid);
  const double frame = double(stream.message_bytes) * grid.count();
  const double wanted = quick ? kQuickRoundBytes : kRoundBytes;
  stream.messages = static_cast<int>(grid.count()) * std::max(1, static_cast<int>(wanted / frame));
  stream.rounds = 1 + (quick ? kQuickRounds : kRounds);
  StreamResult result;
  result.bytes = double(stream.message_bytes) * stream.messages;
  result.seconds = time_mpi_stream(stream);
  if (!result.seconds.empty()) result.seconds.erase(result.seconds.begin());  // sets itself up
  return result;
}

std::string stream_json(const StreamResult& result) {
  return Json{{"bytes", result.bytes}, {"seconds", result.seconds}}.dump() + "\n";
}

Result<StreamResult> parse_stream(const std::string& json, const std::string& where) {
  try {
    const Json from = Json::parse(json);
    StreamResult result;
    from.at("bytes").get_to(result.bytes);
    from.at("seconds").get_to(result.seconds);
    return result;
  } catch (const Json::exception& error) {
    return Failure{where, error.what(), "", ExitStatus::kClusterFailed};
  }
}

}  // namespace goldthread::bench
