// SPDX-License-Identifier: Apache-2.0
#include "bench/motion/playback.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numeric>
#include <utility>

#include "bench/error/frame.h"

namespace goldthread::bench {
namespace {

double mean(const std::vector<double>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

/// A method and its screen on the virtual clock.
class Player {
 public:
  Player(MotionMethod& method, const CameraPath& path) : method_(method), path_(path) {}

  void run_until(double seconds) {
    while (clock_ < seconds) {
      WorkDone done = method_.work(clock_, newest_input(path_, clock_));
      clock_ += done.seconds;
      if (done.shown) coming_.emplace_back(clock_, std::move(*done.shown));
    }
    for (; !coming_.empty() && coming_.front().first <= seconds; coming_.pop_front()) {
      screen_ = std::move(coming_.front().second);
      changed_ = true;
    }
  }

  void look(double seconds, std::span<const Color> exact) {
    const bool changed = std::exchange(changed_, false);
    if (seconds < kWarmUpSeconds) return;
    showing_.seconds.push_back(seconds);
    // Nothing on the screen is as far off as can be.
    showing_.rms.push_back(screen_.colors ? rms_error(*screen_.colors, exact) : 255);
    showing_.latency.push_back(seconds - screen_.input_seconds);
    changes_ += changed ? 1 : 0;
  }

  Showing showing() const {
    Showing result = showing_;
    result.pictures_per_second = changes_ * kDisplaysPerSecond / double(result.seconds.size());
    return result;
  }

 private:
  MotionMethod& method_;
  const CameraPath& path_;
  double clock_ = 0;
  std::deque<std::pair<double, ShownPicture>> coming_;
  ShownPicture screen_;
  bool changed_ = false;
  double changes_ = 0;
  Showing showing_;
};

}  // namespace

double Showing::mean_rms() const { return mean(rms); }

double Showing::mean_latency() const { return mean(latency); }

double Showing::percentile95_rms() const {
  if (rms.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> sorted = rms;
  std::sort(sorted.begin(), sorted.end());
  return sorted[static_cast<std::size_t>(std::ceil(0.95 * double(sorted.size()))) - 1];
}

double rms_error(std::span<const Color> shown, std::span<const Color> exact) {
  double sum = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const Color off = shown[i] - exact[i];
    sum += glm::dot(off, off);
  }
  return 255 * std::sqrt(sum / (3 * double(exact.size())));
}

std::vector<Showing> play(const CameraPath& path,
                          std::span<const std::unique_ptr<MotionMethod>> methods,
                          const std::function<std::vector<Color>(const Camera&)>& exact,
                          const PlaybackSettings& settings) {
  std::vector<Player> players;
  for (const auto& method : methods) players.emplace_back(*method, path);
  const int looks = static_cast<int>(std::floor(settings.seconds * kDisplaysPerSecond));
  for (int look = 1; look <= looks; ++look) {
    settings.progress(double(look - 1) / looks);
    const double seconds = look / kDisplaysPerSecond;
    const std::vector<Color> picture = exact(newest_input(path, seconds));
    in_parallel(settings.threads, players.size(), [&](std::size_t i) {
      players[i].run_until(seconds);
      players[i].look(seconds, picture);
    });
  }
  std::vector<Showing> result(players.size());
  std::transform(players.begin(), players.end(), result.begin(),
                 [](const Player& player) { return player.showing(); });
  return result;
}

}  // namespace goldthread::bench
