// SPDX-License-Identifier: Apache-2.0
// The report as JSON.

#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/error/adaptive_json.h"
#include "bench/error/json_parts.h"
#include "bench/error/report.h"

namespace goldthread::bench {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const PictureError& error) {
  return {{"rms", error.rms},
          {"percentile999", error.percentile_999},
          {"max", error.maximum},
          {"shareOffBy32", error.share_off_by_32}};
}

Json json_of(const MethodRow& row) {
  Json json{{"program", row.program},
            {"look", name_of(row.look)},
            {"how", row.how},
            {"stepVoxels", row.step_voxels > 0 ? Json(row.step_voxels) : Json("default")},
            {"seconds", json_of(row.seconds)},
            {"rays", row.rays},
            {"error", json_of(row.error)}};
  if (!row.instruction_set.empty()) json["instructionSet"] = row.instruction_set;
  if (row.samples > 0) {
    json["samples"] = row.samples;
    json["samplesPerSecond"] = row.samples_per_second();
  }
  if (row.shift) json["shiftPixels"] = {row.shift->x, row.shift->y};
  return json;
}

Json json_of(const ReferenceRow& row) {
  return {{"look", name_of(row.look)},
          {"substeps", row.substeps},
          {"rmsHalved", row.halved},
          {"rmsDoubled", row.doubled},
          {"smallestError", row.smallest_error},
          {"converged", row.is_converged()},
          {"seconds", row.seconds}};
}

Json json_of(const RatioRow& row) {
  Json json{{"name", row.name}, {"kernel", row.kernel}, {"seconds", json_of(row.seconds)}};
  if (row.base.empty()) return json;
  json["against"] = row.base;
  json["medianRatio"] = row.by_rounds;
  json["ratioOfMinima"] = row.by_minimum;
  json["off"] = row.off;
  return json;
}

Json json_of(const LatencyRow& row) {
  return {{"what", row.what}, {"program", row.program}, {"seconds", json_of(row.seconds)}};
}

Json json_of(const GatherRow& row) {
  return {{"instructionSet", row.instruction_set},
          {"seconds", json_of(row.seconds)},
          {"samples", row.samples},
          {"samplesPerSecond", row.samples_per_second()}};
}

Json json_of(const PeerRow& row) {
  Json json{{"name", row.name}, {"version", row.version}};
  if (!row.failure.empty()) json["missing"] = row.failure;
  return json;
}

template <class Row>
Json list_of(const std::vector<Row>& rows) {
  Json list = Json::array();
  for (const Row& row : rows) list.push_back(json_of(row));
  return list;
}

}  // namespace

Json json_of(const Seconds& seconds) {
  return {{"min", seconds.minimum}, {"median", seconds.median}, {"frames", seconds.count}};
}

std::string report_json(const Report& report) {
  const Json json{{"bench", "error"},
                  {"version", report.version},
                  {"date", report.date},
                  {"machine", json_of(report.machine)},
                  {"instructionSet", report.instruction_set},
                  {"scene", report.scene},
                  {"volume", report.volume},
                  {"size", {report.size.width, report.size.height}},
                  {"threads", report.threads},
                  {"repeats", report.repeats},
                  {"stride", report.stride},
                  {"quick", report.quick},
                  {"voxelMm", report.voxel_mm},
                  {"isovalues", {report.isovalue, report.next_isovalue}},
                  {"goals", list_of(goals_of(report))},
                  {"references", list_of(report.references)},
                  {"methods", list_of(report.methods)},
                  {"latencies", list_of(report.latencies)},
                  {"adaptive", json_of(report.adaptive)},
                  {"interrupts", list_of(report.interrupts)},
                  {"storages", list_of(report.storages)},
                  {"features", list_of(report.features)},
                  {"gatherAndLerp", list_of(report.gathers)},
                  {"memory",
                   {{"voxelBytes", report.memory.voxel_bytes},
                    {"blockBytes", report.memory.block_bytes},
                    {"commitBytes", report.memory.commit_bytes},
                    {"shareBeyondVoxels", report.memory.beyond()}}},
                  {"peers", list_of(report.peers)},
                  {"notes", report.notes}};
  // What a library or a file has said may be anything but UTF-8.
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace goldthread::bench
