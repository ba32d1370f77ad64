// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "bench/error/json_parts.h"
#include "bench/scale/scale_report.h"

namespace goldthread::bench {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Affine& cost) { return {{"us", cost.us}, {"usPerByte", cost.us_per_byte}}; }

Json json_of(const MeasuredLink& link) {
  const FittedLink fit = fit_link(link);
  Json times = Json::array();
  for (const MessageTime& time : link.times)
    times.push_back({{"bytes", time.bytes},
                     {"sendUs", time.send_us},
                     {"receiveUs", time.receive_us},
                     {"transitUs", time.transit_us}});
  return {{"ranks", link.name},
          {"send", json_of(fit.costs.send)},
          {"sendResidual", fit.send_residual},
          {"receive", json_of(fit.costs.receive)},
          {"receiveResidual", fit.receive_residual},
          {"transit", json_of(fit.costs.transit)},
          {"transitResidual", fit.transit_residual},
          {"times", times}};
}

Json json_of(const MasterCosts& costs) {
  return {{"workers", costs.workers},
          {"doneUs", costs.done_us},
          {"supplyUs", costs.supply_us},
          {"queueUsPerTile", costs.queue_us},
          {"beginUsPerWorker", costs.begin_us}};
}

Json json_of(const ValidationRow& row) {
  return {{"rays", row.rays},
          {"work", row.work},
          {"workers", row.workers},
          {"measuredUs", row.measured_us},
          {"simulatedUs", row.simulated_us},
          {"ratio", row.ratio()}};
}

Json json_of(const SweepPoint& point, const std::vector<std::string>& views) {
  return {{"view", views[std::size_t(point.view)]},
          {"megapixels", point.megapixels},
          {"tile", point.tile_px},
          {"tiles", point.tiles},
          {"tileUs", point.tile_us},
          {"workers", point.shape.workers},
          {"masters", point.shape.masters},
          {"compositors", point.shape.compositors},
          {"tilesPerChunk", point.shape.tiles_per_chunk},
          {"us", point.frame.us},
          {"efficiency", point.frame.efficiency},
          {"limit", limit_of(point)},
          {"masterBusy", point.frame.master_busy},
          {"topBusy", point.frame.top_busy},
          {"compositorBusy", point.frame.compositor_busy},
          {"masterWaitUs", point.frame.master_wait_us},
          {"compositorsLateUs", point.frame.compositors_late_us},
          {"imbalance", point.frame.imbalance},
          {"quanta", point.frame.quanta},
          {"takenOver", point.frame.taken_over},
          {"messagesPerSecond", point.frame.most_messages}};
}

template <class Items, class... More>
Json array_of(const Items& items, const More&... more) {
  Json array = Json::array();
  for (const auto& item : items) array.push_back(json_of(item, more...));
  return array;
}

Json views_of(const ScaleReport& report) {
  Json views = Json::array();
  for (std::size_t i = 0; i < report.views.size(); ++i) {
    Json steps = Json::array();
    for (const LinearFit& price : report.prices[i])
      steps.push_back({{"rayUs", price.first}, {"sampleUs", price.second}});
    views.push_back(
        {{"name", report.views[i]}, {"threadSeconds", report.thread_seconds[i]}, {"steps", steps}});
  }
  return views;
}

}  // namespace

std::string scale_json(const ScaleReport& report) {
  const Json json{{"bench", "scale"},
                  {"version", report.version},
                  {"date", report.date},
                  {"machine", json_of(report.machine)},
                  {"kernel", report.kernel},
                  {"scene", report.scene},
                  {"size", {report.recorded_size.width, report.recorded_size.height}},
                  {"views", views_of(report)},
                  {"links", array_of(report.links)},
                  {"master", array_of(report.model.master)},
                  {"compositor", json_of(report.model.place)},
                  {"compositorResidual", report.placing_residual},
                  {"validation", array_of(report.validation)},
                  {"oneLevel", array_of(report.one_level, report.views)},
                  {"twoLevels", array_of(report.two_levels, report.views)},
                  {"withSecondLevel", array_of(report.with_second_level, report.views)},
                  {"notes", report.notes}};
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace goldthread::bench
