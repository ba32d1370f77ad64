// SPDX-License-Identifier: Apache-2.0
#include "master/report.h"

#include <map>
#include <nlohmann/json.hpp>

#include "master/names.h"
#include "master/stop_rule.h"

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
    list.push_back({{"seconds", shown != nullptr ? shown->held.count() : 0},
                    {"rays", view.rays},
                    {"samples", view.samples},
                    {"samplesPerPixel", double(view.rays) / view.pixels()},
                    {"estimatedError", estimated_error(view)},
                    {"firstPictureSeconds", view.steps.empty() ? 0 : view.steps[0].held.count()},
                    {"takenSeconds", view.taken.count()},
                    {"steps", steps_of(view)}});
  }
  return list;
}

Json tiles_of(const ViewState& view) {
  Json list = Json::array();
  for (std::uint32_t i = 0; i < view.grid.count(); ++i) {
    const PixelRect rect = view.grid.rect({i});
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
                    {"busySeconds", ranks[i].busy_seconds}});
  }
  return list;
}

Json bytes_of(const std::vector<RankState>& ranks) {
  std::map<std::string, std::uint64_t> sums;
  for (const RankState& rank : ranks) {
    for (const MessageCount& count : rank.sent) sums[count.kind] += count.bytes;
  }
  return Json(sums);
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

std::string report_json(const Cluster& cluster, const std::vector<ViewState>& frames,
                        double load_seconds) {
  const Json report = {{"frames", frames_of(frames)},
                       {"features", cluster.features()},
                       {"kernel", cluster.kernel()},
                       {"ranks", ranks_of(cluster.ranks())},
                       {"tiles", frames.empty() ? Json::array() : tiles_of(frames.back())},
                       {"bytes", bytes_of(cluster.ranks())},
                       {"links", links_of(cluster.ranks())},
                       {"loadSeconds", load_seconds},
                       {"version", GOLDTHREAD_VERSION}};
  return report.dump(2) + "\n";
}

}  // namespace goldthread
