// SPDX-License-Identifier: Apache-2.0
#include "master/report.h"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "master/names.h"

namespace goldthread {
namespace {

using Json = nlohmann::ordered_json;

Json frames_of(const std::vector<ViewState>& frames) {
  Json list = Json::array();
  for (const ViewState& view : frames) {
    list.push_back({{"seconds", view.complete.count()},
                    {"rays", view.rays},
                    {"samples", view.samples},
                    {"estimatedError", estimated_error(view)},
                    {"firstPictureSeconds", view.first_picture.count()},
                    {"spacing", view.level().value_or(kCoarsestLevel).spacing_px()}});
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

}  // namespace

double estimated_error(const ViewState& view) { return 255 * std::sqrt(view.squared_error); }

std::string report_json(const Cluster& cluster, const std::vector<ViewState>& frames,
                        double load_seconds) {
  const Json report = {{"frames", frames_of(frames)},
                       {"features", cluster.features()},
                       {"kernel", cluster.kernel()},
                       {"ranks", ranks_of(cluster.ranks())},
                       {"tiles", frames.empty() ? Json::array() : tiles_of(frames.back())},
                       {"bytes", bytes_of(cluster.ranks())},
                       {"loadSeconds", load_seconds},
                       {"version", GOLDTHREAD_VERSION}};
  return report.dump(2) + "\n";
}

}  // namespace goldthread
