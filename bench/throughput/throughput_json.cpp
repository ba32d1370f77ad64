// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "bench/error/json_parts.h"
#include "bench/throughput/throughput_report.h"

namespace goldthread::bench {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const FramesRow& row) {
  const RanksSetup& setup = row.setup;
  Json json{{"carrier", name_of(setup.carrier)},
            {"size", {setup.size.width, setup.size.height}},
            {"tile", setup.tile_px},
            {"workers", setup.workers},
            {"bypassed", setup.bypass},
            {"framesPerSecond", row.frames_per_second()},
            {"losslessFramesPerSecond", row.lossless_per_second()},
            {"tilesPerSecond", row.tiles_per_second()},
            {"tilesPerMasterSecond", row.frames.tiles_per_master_second()},
            {"sampleBytesPerSecond", row.sample_bytes_per_second()},
            {"frames", Json::parse(frames_json(row.frames))}};
  if (row.stream) {
    json["mpiAloneBytesPerSecond"] = row.stream->bytes_per_second();
    json["stream"] = Json::parse(stream_json(*row.stream));
    json["shares"] = row.shares;
  }
  return json;
}

Json json_of(const Seconds& seconds) {
  return {{"min", seconds.minimum}, {"median", seconds.median}, {"count", seconds.count}};
}

Json json_of(const BackEndRow& row) {
  return {{"samples", row.samples},
          {"known", row.known},
          {"shown", json_of(row.shown)},
          {"jpeg", json_of(row.jpeg)},
          {"zstd", json_of(row.zstd)},
          {"samplesToJpeg", json_of(row.all_jpeg)},
          {"samplesToZstd", json_of(row.all_zstd)}};
}

template <class Item>
Json list_of(const std::vector<Item>& items) {
  Json list = Json::array();
  for (const Item& item : items) list.push_back(json_of(item));
  return list;
}

}  // namespace

std::string throughput_json(const ThroughputReport& report) {
  const Json json{{"bench", "throughput"},
                  {"version", report.version},
                  {"date", report.date},
                  {"machine", json_of(report.machine)},
                  {"scene", report.scene},
                  {"goals", list_of(throughput_goals(report))},
                  {"everythingBypassed", list_of(report.bypassed)},
                  {"masterAlone", list_of(report.master)},
                  {"backEndAlone", list_of(report.back_end)},
                  {"backEndParts", list_of(report.parts)},
                  {"notes", report.notes}};
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace goldthread::bench
