// SPDX-License-Identifier: Apache-2.0
#include "master/report.h"

#include <nlohmann/json.hpp>

#include "master/balance.h"
#include "master/names.h"
#include "master/stop_rule.h"
#include "master/traffic.h"

namespace goldthread {
namespace {

using Json = nlohmann::ordered_json;

Json steps_of(const ViewState& view) {
  Json list = Json::array();
  for (const StepState& step : view.steps) {
    list.push_back({{"rays", step.rays},
                    {"estimatedError", rms_error(step.quality.squared_error, view.pixels())},
                    {"seconds", step.held.count()}});
  }
  return list;
}

Json frames_of(const std::vector<ViewState>& frames) {
  Json list = Json::array();
  for (const ViewState& view : frames) {
    const StepState* shown = view.shown();
    const auto error = prediction_error(view);
    list.push_back({{"seconds", shown != nullptr ? shown->held.count() : 0},
                    {"rays", view.rays},
                    {"samples", view.samples},
                    {"samplesPerPixel", double(view.rays) / view.pixels()},
                    {"estimatedError", estimated_error(view)},
                    {"firstPictureSeconds", view.steps.empty() ? 0 : view.steps[0].held.count()},
                    {"takenSeconds", view.taken.count()},
                    {"imbalance", imbalance(view.worker_seconds)},
                    {"predictionError", error ? Json(*error) : Json()},
                    {"steps", steps_of(view)}});
  }
  return list;
}

Json tiles_of(const ViewState& view) {
  Json list = Json::array();
  const auto rects = view.grid.rects();
  for (std::size_t i = 0; i < rects.size(); ++i) {
    const PixelRect& rect = rects[i];
    list.push_back({{"x", rect.x},
                    {"y", rect.y},
                    {"width", rect.width},
                    {"height", rect.height},
                    {"worker", view.tiles[i].worker.value},
                    {"seconds", view.tiles[i].seconds}});
  }
  return list;
}

Json ranks_of(const std::vector<RankState>& ranks) {
  Json list = Json::array();
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    list.push_back({{"rank", i},
                    {"role", role_name(ranks[i].role)},
                    {"host", ranks[i].host},
                    {"busySeconds", ranks[i].busy_seconds},
                    {"peakMemoryBytes", ranks[i].peak_memory_bytes}});
  }
  return list;
}

/// Of what all ranks have sent, by kind of message.
Json sums_of(const std::vector<RankState>& ranks, std::uint64_t MessageCount::*what) {
  Json sums = Json::object();
  for (const auto& [kind, count] : traffic_of(ranks)) sums[kind] = count.*what;
  return sums;
}

/// What ranks know of their links and did about it; MB are 10⁶ bytes.
Json links_of(const std::vector<RankState>& ranks) {
  Json list = Json::array();
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    for (const LinkCount& link : ranks[i].links) {
      list.push_back({{"from", i},
                      {"to", link.to},
                      {"megabytesPerSecond", 1e-6 * link.bytes_per_second},
                      {"ratio", link.ratio},
                      {"compressMegabytesPerSecond", 1e-6 * link.compress_per_s},
                      {"decompressMegabytesPerSecond", 1e-6 * link.decompress_per_s},
                      {"messages", link.messages},
                      {"compressed", link.coded},
                      {"rawBytes", link.raw_bytes},
                      {"sentBytes", link.sent_bytes}});
    }
  }
  return list;
}

}  // namespace

double estimated_error(const ViewState& view) {
  const StepState* shown = view.shown();
  return shown != nullptr ? rms_error(shown->quality.squared_error, view.pixels()) : 255;
}

std::optional<double> prediction_error(const ViewState& view) {
  if (!view.predicted) return {};
  std::vector<double> predicted, actual;
  for (const ViewState::Tile& tile : view.tiles) {
    predicted.push_back(tile.predicted_seconds);
    actual.push_back(tile.compared_seconds);
  }
  return prediction_error(predicted, actual);
}

std::string report_json(const Cluster& cluster, const std::vector<ViewState>& frames,
                        double load_seconds, const std::vector<std::string>& bypassed) {
  const Json report = {{"frames", frames_of(frames)},
                       {"features", cluster.features()},
                       {"kernel", cluster.kernel()},
                       {"ranks", ranks_of(cluster.ranks())},
                       {"tiles", frames.empty() ? Json::array() : tiles_of(frames.back())},
                       {"messages", sums_of(cluster.ranks(), &MessageCount::messages)},
                       {"bytes", sums_of(cluster.ranks(), &MessageCount::bytes)},
                       {"links", links_of(cluster.ranks())},
                       {"bypassed", bypassed},
                       {"loadSeconds", load_seconds},
                       {"version", GOLDTHREAD_VERSION}};
  return report.dump(2) + "\n";
}

}  // namespace goldthread
