// SPDX-License-Identifier: Apache-2.0
#include "master/load_messages.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string_view>
#include <utility>

#include "common/base/busy_log.h"
#include "master/names.h"

namespace goldthread {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kBinsOfASecond = std::chrono::seconds(1) / BusyLog::kBin;

double milliseconds_of(std::chrono::duration<double, std::milli> time) {
  return std::round(1000 * time.count()) / 1000;
}
double rounded(double seconds) { return std::round(1e6 * seconds) / 1e6; }

/// A bin a character, 0 … 63 in the digits of base64url.
std::string text_of(const std::vector<std::uint8_t>& share) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  std::string text;
  for (const std::uint8_t value : share)
    text += kDigits[static_cast<std::size_t>((value * 63 + 127) / 255)];
  return text;
}

Json rank_of(const Cluster& cluster, int i, Clock::time_point now) {
  const RankState& rank = cluster.ranks()[static_cast<std::size_t>(i)];
  const RankActivity& activity = rank.activity;
  Json json{{"rank", i},
            {"role", role_name(rank.role)},
            {"lost", rank.lost},
            {"busy", rounded(busy_in_last_second(activity.share))},
            {"share", text_of(activity.share)},
            {"age", milliseconds_of(now - activity.end)},
            {"error", milliseconds_of(activity.error)}};
  const ViewState& view = cluster.whole_view();
  if (rank.role == Role::kWorker && !view.worker_seconds.empty()) {
    const int worker = cluster.topology().worker_index({i});
    const double seconds = view.worker_seconds[static_cast<std::size_t>(worker)];
    json["view"] = rounded(seconds / std::max(1, rank.threads));
  }
  return json;
}

}  // namespace

double busy_in_last_second(const std::vector<std::uint8_t>& share) {
  const auto bins = std::min<std::ptrdiff_t>(kBinsOfASecond, std::ssize(share));
  if (bins == 0) return 0;
  return std::accumulate(share.end() - bins, share.end(), 0.0) / (255.0 * double(bins));
}

std::string load_message(const Cluster& cluster, const std::vector<TrafficRate>& traffic,
                         Clock::time_point now) {
  Json ranks = Json::array(), bytes = Json::array();
  for (int i = 0; i < cluster.topology().size(); ++i)
    if (!cluster.ranks()[static_cast<std::size_t>(i)].activity.share.empty())
      ranks.push_back(rank_of(cluster, i, now));
  for (const TrafficRate& rate : traffic) {
    bytes.push_back({{"kind", rate.total.kind},
                     {"messages", rate.total.messages},
                     {"total", rate.total.bytes},
                     {"perSecond", std::round(rate.bytes_per_s)}});
  }
  return Json{{"type", "load"}, {"bin", BusyLog::kBin.count()}, {"ranks", ranks}, {"bytes", bytes}}
      .dump();
}

std::string tiles_message(const ViewState& view) {
  Json tiles = Json::array();
  for (std::uint32_t i = 0; i < view.grid.count(); ++i) {
    const PixelRect rect = view.grid.rect({i});
    const ViewState::Tile& tile = view.tiles[i];
    for (const int value : {rect.x, rect.y, rect.width, rect.height, tile.worker.value})
      tiles.push_back(value);
    tiles.push_back(rounded(1e3 * tile.seconds));
  }
  return Json{{"type", "tiles"},
              {"epoch", view.epoch.value},
              {"width", view.grid.image.width},
              {"height", view.grid.image.height},
              {"tile", {view.grid.tile.width, view.grid.tile.height}},
              {"tiles", tiles}}
      .dump();
}

void LoadTeller::watch(bool load, bool tiles) {
  if (!load && load_) {
    asked_.reset();
    meter_ = {};
  }
  if (tiles && !tiles_) told_.reset();
  load_ = load;
  tiles_ = tiles;
}

void LoadTeller::tell(Cluster& cluster, Clock::time_point now, const Send& send) {
  if (load_) tell_load(cluster, now, send);
  if (tiles_) tell_tiles(cluster, now, send);
}

void LoadTeller::tell_load(Cluster& cluster, Clock::time_point now, const Send& send) {
  if (!asked_ && now >= next_load_) {
    cluster.request_counters(/*activity=*/true);
    asked_ = now;
    next_load_ = now + kInterval;
    return;
  }
  // Who is late is shown as it was.
  if (!asked_ || !(cluster.activity_complete() || now >= *asked_ + kInterval)) return;
  asked_.reset();
  send(load_message(cluster, meter_.sample(now, traffic_of(cluster.ranks())), now));
}

void LoadTeller::tell_tiles(const Cluster& cluster, Clock::time_point now, const Send& send) {
  const ViewState& view = cluster.whole_view();
  const std::pair state{view.epoch, view.rays};
  const bool is_new = told_ != state || now >= last_tiles_ + kRepeat;
  if (view.tiles.empty() || !is_new || now < last_tiles_ + kInterval) return;
  last_tiles_ = now;
  told_ = state;
  send(tiles_message(view));
}

}  // namespace goldthread
