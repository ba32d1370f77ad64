// SPDX-License-Identifier: Apache-2.0
#pragma once
// How the work is spread, told to the pages that watch it (docs/viewer-protocol.md, "The load").

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "master/cluster.h"
#include "master/traffic.h"

namespace goldthread {

/// What of one thread's time the bins say was computed in the last second, 0 … 1.
double busy_in_last_second(const std::vector<std::uint8_t>& share);

/// The ranks' bars and time lines as of `now`, and the bytes by kind of message.
std::string load_message(const Cluster& cluster, const std::vector<TrafficRate>& traffic,
                         Clock::time_point now);
/// Who cast the tiles of a view, and how long. `view` has tiles.
std::string tiles_message(const ViewState& view);

/// Tells a few times a second what is watched, and asks the ranks for no more than that.
class LoadTeller {
 public:
  using Send = std::function<void(std::string json)>;
  static constexpr std::chrono::milliseconds kInterval{250};
  /// Tiles that stay as they are are told again, for pages that have just begun to watch.
  static constexpr std::chrono::milliseconds kRepeat{1000};

  void watch(bool load, bool tiles);
  /// Sends what is due at `now`. To be called often.
  void tell(Cluster& cluster, Clock::time_point now, const Send& send);

 private:
  void tell_load(Cluster& cluster, Clock::time_point now, const Send& send);
  void tell_tiles(const Cluster& cluster, Clock::time_point now, const Send& send);

  bool load_ = false, tiles_ = false;
  std::optional<Clock::time_point> asked_;  ///< a request that is not answered by all
  Clock::time_point next_load_{};
  Clock::time_point last_tiles_{};
  TrafficMeter meter_;
  /// The view that was told last, and how many rays it had.
  std::optional<std::pair<Epoch, std::uint64_t>> told_;
};

}  // namespace goldthread
